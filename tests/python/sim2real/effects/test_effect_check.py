"""`pdoik effects check`: every effect of the catalogue passes, and wrong ones are caught."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.cli import app
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray
from pdoik.sim2real.effect_check import Arm, Outcome, check_effect, load_effects
from pdoik.sim2real.effects import CATALOGUE, Effect, Example, Parameter, Site
from pdoik.sim2real.effects.friction import StribeckFriction
from pdoik.sim2real.effects.transmission import TorqueRipple
from pdoik.sim2real.motion import Columns, Motion, Place, Shape
from pdoik.sim2real.simulation import Dahl, JointTorque, Part

COLUMNS, BACK, BOUNDS = "columns against simulation", "there and back", "bounds"
NOTHING, GRADIENTS, STIFFNESS = "at zero nothing", "gradients", "stiffness of its law"
WORDS, FOUND = "units and words", "found"


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Arm:
    return Arm(tmp_path_factory.mktemp("arm"))


def failed(outcomes: tuple[Outcome, ...]) -> dict[str, Outcome]:
    return {each.check: each for each in outcomes if each.status == "fail"}


# The arm stands fixed: effects of floating bases are held against MuJoCo elsewhere.
@pytest.mark.parametrize("effect", [k for k, e in CATALOGUE.items() if not e.of_floating_base])
def test_every_effect_of_the_catalogue_is_what_it_says(arm: Arm, effect: str) -> None:
    outcomes = {each.check: each for each in check_effect(CATALOGUE[effect], arm=arm)}
    assert not failed(tuple(outcomes.values()))
    assert set(outcomes) == {COLUMNS, BACK, BOUNDS, NOTHING, GRADIENTS, STIFFNESS, WORDS}
    for each in outcomes.values():
        assert each.words
        assert each.status == "not applicable" or each.measured <= each.limit
    skipped = {name for name, each in outcomes.items() if each.status == "not applicable"}
    assert skipped <= {GRADIENTS, STIFFNESS} or effect == "sensor_noise"


class Drag(Effect):
    """A right effect, of which the wrong ones below are made."""

    id = "drag"
    family = "friction"
    on = "joint"
    equation = "tau = c dq |dq|"
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=0.0),)
    source = "the test"
    decided_by = "motion at two speeds"
    example = Example(values={"coefficient": 2.0})

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        (j,) = place.joints
        return {("torque", j): (motion.dq[:, j] * np.abs(motion.dq[:, j]))[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        return {"coefficient": float(beta[0])}

    def parts(self, site: Site) -> tuple[Part, ...]:
        c = site["coefficient"]
        return site.each(
            lambda j: JointTorque(joint=j, law=lambda t, q, dq, load: c * dq * abs(dq))
        )

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        return f"{where} is held back by {values['coefficient']:.3g} N m per (rad/s)^2."


def test_a_right_effect_passes(arm: Arm) -> None:
    assert not failed(check_effect(Drag(), arm=arm))


class SignFlipped(Drag):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        return {key: -column for key, column in super().columns(motion, place, shape).items()}


class TwiceAsLarge(Drag):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        return {key: 2.0 * column for key, column in super().columns(motion, place, shape).items()}


class AtAnotherJoint(Drag):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        (own,) = super().columns(motion, place, shape).values()
        return {("torque", 0): own}


class WithoutColumns(Drag):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        return {}


class TooSmall(Drag):
    example = Example(values={"coefficient": 1e-5})


class ReadWrongly(Drag):
    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        return {"coefficient": 2.0 * float(beta[0])}


class TurnedRoundWrongly(TorqueRipple):
    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        amplitude, phase = values["amplitude"], values["phase"]
        return (values["harmonic"],), amplitude * np.array([np.cos(phase), np.sin(phase)])


class BoundsCrossed(Drag):
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=5.0, upper=1.0),)


class ExampleOutside(Drag):
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=0.0, upper=1.0),)


class ChosenWithoutEnd(Drag):
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=0.0, chosen=True),)


class TakesAnything(Drag):
    def admissible(self, beta: FloatArray) -> bool:
        return True


class TakesNothing(Drag):
    def admissible(self, beta: FloatArray) -> bool:
        return False


class SearchedElsewhere(StribeckFriction):
    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        return [(2.0 * shape[0], 3.0 * shape[0])]


class NeverNothing(Drag):
    def parts(self, site: Site) -> tuple[Part, ...]:
        c = site["coefficient"] + 0.3
        return site.each(
            lambda j: JointTorque(joint=j, law=lambda t, q, dq, load: c * dq * abs(dq))
        )


class Rough(StribeckFriction):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        return super().columns(motion, place, (round(shape[0], 2),))


class Softer(Dahl):
    def __init__(self, level: float, displacement: float) -> None:
        super().__init__(level, displacement)
        self.stiffness *= 0.5


class SofterThanItSays(Drag):
    def parts(self, site: Site) -> tuple[Part, ...]:
        return site.each(lambda j: JointTorque(joint=j, law=Softer(1.0, 0.02)))


class OddUnit(Drag):
    parameters = (Parameter("coefficient", "Nm/rpm", lower=0.0),)


class NoUnit(Drag):
    parameters = (Parameter("coefficient", "", lower=0.0),)


class Placeless(Drag):
    def statement(self, where: str, values: Mapping[str, float]) -> str:
        return "Something is held back."


class StatementFails(Drag):
    def statement(self, where: str, values: Mapping[str, float]) -> str:
        return f"{where}: {values['coeficient']}"


class ColumnsRaise(Drag):
    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        raise RuntimeError("no such thing")


@pytest.mark.parametrize(
    ("effect", "check"),
    [
        (SignFlipped, COLUMNS),
        (TwiceAsLarge, COLUMNS),
        (AtAnotherJoint, COLUMNS),
        (WithoutColumns, COLUMNS),
        (TooSmall, COLUMNS),
        (ReadWrongly, BACK),
        (TurnedRoundWrongly, BACK),
        (BoundsCrossed, BOUNDS),
        (ExampleOutside, BOUNDS),
        (ChosenWithoutEnd, BOUNDS),
        (TakesAnything, BOUNDS),
        (TakesNothing, BOUNDS),
        (SearchedElsewhere, BOUNDS),
        (NeverNothing, NOTHING),
        (Rough, GRADIENTS),
        (SofterThanItSays, STIFFNESS),
        (OddUnit, WORDS),
        (NoUnit, WORDS),
        (Placeless, WORDS),
        (StatementFails, WORDS),
        (ColumnsRaise, COLUMNS),
    ],
)
def test_what_is_wrong_with_an_effect_is_caught_by_its_check(
    arm: Arm, effect: type[Effect], check: str
) -> None:
    wrong = failed(check_effect(effect(), arm=arm))
    assert check in wrong
    assert wrong[check].words
    assert not wrong[check].measured <= wrong[check].limit


@pytest.mark.parametrize("effect", [SignFlipped, TwiceAsLarge, OddUnit, TakesAnything])
def test_other_checks_do_not_fail_along(arm: Arm, effect: type[Effect]) -> None:
    assert len(failed(check_effect(effect(), arm=arm))) == 1


def test_an_effect_without_an_example_is_told_what_to_write(arm: Arm) -> None:
    bare = type("Bare", (Drag,), {"example": None})()
    (outcome,) = check_effect(bare, arm=arm)
    assert outcome.status == "fail"
    assert "Example(values={...})" in outcome.words
    misspelt = type("Misspelt", (Drag,), {"example": Example(values={"level": 1.0})})()
    assert failed(check_effect(misspelt, arm=arm))


def test_a_check_leaves_the_catalogue_as_it_was(arm: Arm) -> None:
    before = dict(CATALOGUE)
    check_effect(Drag(), arm=arm)
    assert before == CATALOGUE


# Files

HEAD = """
import numpy as np
from pdoik.sim2real import register
from pdoik.sim2real.effects import Effect, Example, Parameter
from pdoik.sim2real.simulation.parts import JointTorque

class Drag(Effect):
    id = "drag"
    on = "joint"
    equation = "tau = c dq |dq|"
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=0.0),)
    source = "the test"
    decided_by = "motion at two speeds"
    example = Example(values={"coefficient": 2.0})

    def columns(self, motion, place, shape):
        (j,) = place.joints
        return {("torque", j): SIGN * (motion.dq[:, j] * np.abs(motion.dq[:, j]))[:, None]}

    def values(self, shape, beta):
        return {"coefficient": float(beta[0])}

    def parts(self, site):
        c = site["coefficient"]
        law = lambda t, q, dq, load: c * dq * abs(dq)
        return site.each(lambda j: JointTorque(joint=j, law=law))

    def statement(self, where, values):
        return f"{where}: {values['coefficient']:.3g} N m per (rad/s)^2."
"""


def file(folder: Path, text: str, sign: float = 1.0) -> Path:
    path = folder / "mine.py"
    path.write_text(text.replace("SIGN", repr(sign)))
    return path


@pytest.mark.parametrize("tail", ["", "mine = Drag()\n", "register(Drag)\n", "register(Drag())\n"])
def test_a_class_an_instance_and_what_is_registered_are_found_once(
    tmp_path: Path, tail: str
) -> None:
    before = dict(CATALOGUE)
    (effect,) = load_effects(str(file(tmp_path, HEAD + tail)))
    assert effect.id == "drag"
    assert before == CATALOGUE


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", "holds no effect"),
        ("import numpy\nx = 1 / 0\n", "line 2: ZeroDivisionError"),
        ("def f(:\n", "does not load.*SyntaxError"),
        ("import no_such_module_of_mine\n", "line 1: ModuleNotFoundError"),
        ("raise SystemExit(3)\n", "does not load, line 1: SystemExit"),
        (
            "from pdoik.sim2real.effects import Effect\nclass Mine(Effect):\n    id = 'mine'\n",
            "Mine lacks columns, statement",
        ),
        (HEAD.replace('id = "drag"', 'id = "backlash"'), "'backlash' in the catalogue already"),
        (HEAD.replace('id = "drag"', 'id = ""'), "Drag has no id"),
        (HEAD.replace('id = "drag"', 'id = "backlash"') + "register(Drag)\n", "another effect"),
    ],
)
def test_a_file_that_is_no_effect_is_told_why(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        load_effects(str(file(tmp_path, text)))
    failed_command = CliRunner().invoke(app, ["effects", "check", str(tmp_path / "mine.py")])
    assert failed_command.exit_code == 2
    assert failed_command.stderr.startswith("error: ")


def test_what_is_neither_a_file_nor_an_id_is_said(tmp_path: Path) -> None:
    with pytest.raises(LoadError, match="nearest: 'backlash'"):
        load_effects("backlsh")
    with pytest.raises(LoadError, match="there is no such file"):
        load_effects(str(tmp_path / "none.py"))


def test_the_command_has_a_line_per_check_and_fails_with_one(tmp_path: Path) -> None:
    good = CliRunner().invoke(app, ["effects", "check", str(file(tmp_path, HEAD))])
    assert good.exit_code == 0, good.output
    for check in (COLUMNS, BACK, BOUNDS, NOTHING, GRADIENTS, STIFFNESS, WORDS):
        assert sum(line.strip().startswith(check) for line in good.stdout.splitlines()) == 1
    bad = CliRunner().invoke(app, ["effects", "check", str(file(tmp_path, HEAD, -1.0))])
    assert bad.exit_code == 1
    (line,) = [each for each in bad.stdout.splitlines() if "fail" in each]
    assert line.strip().startswith(COLUMNS)
    assert " 2 " in line  # a flipped sign leaves twice what there is
    known = CliRunner().invoke(app, ["effects", "check", "viscous_friction"])
    assert known.exit_code == 0
    assert FOUND not in known.stdout


@pytest.mark.long
def test_a_diagnosis_names_the_effect_or_the_check_says_what_it_names(tmp_path: Path) -> None:
    good = load_effects(str(file(tmp_path, HEAD)))[0]
    (outcome,) = [each for each in check_effect(good, diagnose=True) if each.check == FOUND]
    assert outcome.status == "pass"
    assert outcome.words.startswith("named: joint j2") or outcome.words.startswith("named: Joint")
    bad = load_effects(str(file(tmp_path, HEAD, -1.0)))[0]
    (outcome,) = [each for each in check_effect(bad, diagnose=True) if each.check == FOUND]
    assert outcome.status == "fail"
    assert "the diagnosis names" in outcome.words
