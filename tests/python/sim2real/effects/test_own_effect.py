"""An effect that a user wrote is found, simulated and shown like pdoik's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.cli import app
from pdoik.recordings import FloatArray
from pdoik.sim2real import diagnose, register
from pdoik.sim2real.effects import CATALOGUE, Effect, Parameter, Site, parts_of_finding
from pdoik.sim2real.motion import Columns, Motion, Place, Shape
from pdoik.sim2real.simulation import JointTorque, Part
from sim2real_channels import study


class WindDrag(Effect):
    """tau = c dq |dq|."""

    id = "wind_drag"
    family = "friction"
    on = "joint"
    equation = "tau = c dq |dq|"
    parameters = (Parameter("coefficient", "N m s^2/rad^2", lower=0.0),)
    size_first = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        (j,) = place.joints
        speed = motion.dq[:, j]
        return {("torque", j): (speed * np.abs(speed))[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        return {"coefficient": float(beta[0])}

    def parts(self, site: Site) -> tuple[Part, ...]:
        c = site["coefficient"]
        return site.each(
            lambda j: JointTorque(joint=j, law=lambda t, q, dq, load: c * dq * abs(dq))
        )

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        return f"Wind holds {where} back by {values['coefficient']:.3g} N m per (rad/s)^2."


@pytest.fixture
def registered() -> Iterator[None]:
    register(WindDrag)
    yield
    del CATALOGUE[WindDrag.id]


@pytest.mark.usefixtures("registered")
def test_an_effect_of_ones_own_is_found_simulated_and_listed(tmp_path: Path) -> None:
    plain = study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    (logged,) = plain.recordings
    assert logged.tau is not None
    assert logged.dq is not None
    drag = np.zeros_like(logged.tau)
    drag[:, 1] = 2.0 * logged.dq[:, 1] * np.abs(logged.dq[:, 1])
    windy = replace(plain, recordings=(replace(logged, tau=logged.tau + drag),))
    (finding,) = [f for f in diagnose(windy).findings if f.effect == "wind_drag"]
    assert finding.joints == ("j2",)
    assert finding.values["coefficient"] == pytest.approx(2.0, rel=0.03)
    assert finding.statement.startswith("Wind holds joint j2 back by")
    (part,) = parts_of_finding(finding)
    assert isinstance(part, JointTorque)
    assert part.law(0.0, 0.0, -2.0, 0.0) == pytest.approx(-8.0, rel=0.03)
    listed = CliRunner().invoke(app, ["effects", "list"])
    assert "wind_drag" in listed.stdout
    shown = CliRunner().invoke(app, ["effects", "show", "wind_drag"])
    assert "tau = c dq |dq|" in shown.stdout
    assert "coefficient [N m s^2/rad^2], 0 to inf" in shown.stdout


@pytest.mark.usefixtures("registered")
def test_two_effects_of_one_name_are_refused() -> None:
    class Other(WindDrag):
        pass

    with pytest.raises(ValueError, match="another effect 'wind_drag': WindDrag"):
        register(Other)
    with pytest.raises(ValueError, match="Nameless has no id"):
        register(type("Nameless", (WindDrag,), {"id": ""}))


def test_an_effect_that_is_not_there_is_said() -> None:
    asked = CliRunner().invoke(app, ["effects", "show", "backlsh"])
    assert asked.exit_code == 2
    assert "nearest: 'backlash'" in asked.stderr
