"""What is known of real machines, held against diagnoses made up for it, and its tables."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("dask", reason="pip install 'pdoik[bench]'")

from bench.common.publish import published
from bench.sim2real.legged.robots import has_go2
from bench.sim2real.proof import real
from bench.sim2real.proof.real_counts import Count, broken, crashed, holds_nothing, tally, worse
from bench.sim2real.proof.real_facts import (
    delay_between,
    depends_on_position,
    either_friction,
    figures_at,
    friction_at,
    left_at_most,
    no_load_beyond,
    none_of,
    only,
    or_refused,
    tilt_about_y,
)
from bench.sim2real.proof.real_machine import Machine, write_study
from bench.sim2real.proof.real_report import report, totals_table
from bench.sim2real.proof.real_studies import MACHINES
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.study import load_study

BESIDE = Path(__file__).resolve().parents[5] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"

WORDS = "status 1: OverflowError: too large"
CRASH = {"error": WORDS, "seconds": 1.0}


def found(effect: str, *joints: str, links: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    """A finding whose figures are known to a hundredth, or to the interval that is given."""
    figures = more.pop("figures", {"level": 1.0})
    spans = more.pop("spans", {})
    parameters = {
        name: {
            "value": value,
            "interval95": spans.get(name, (value - 0.01 * abs(value), value + 0.01 * abs(value))),
            "unit": "N m",
        }
        for name, value in figures.items()
    }
    rest = {
        "statement": "",
        "confidence": 0.95,
        "equivalents": [],
        "evidence": {"validation_gain": 0.5},
    }
    return {
        "effect": effect,
        "joints": list(joints),
        "links": list(links),
        "parameters": parameters,
        **rest,
        **more,
    }


def said(*findings: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "verdict": "mismatch_explained",
        "findings": [*findings],
        "joints": {},
        "notes": [],
        **more,
    }


def left(before: float, after: float) -> dict[str, Any]:
    return {
        "before": before,
        "after": after,
        "unit": "N m",
        "excited": True,
        "noise_floor": 0.1,
    }


def refused(words: str) -> dict[str, Any]:
    return said(verdict=f"error: {words}")


def stranger(name: str) -> Machine:
    (machine,) = (each for each in MACHINES if each.name == name)
    return machine


# Facts


def test_friction_is_counted_by_joint() -> None:
    told = friction_at(said(found("viscous_friction", "a", "b")), joints=("a", "b", "c"))
    assert (told.needed, told.agrees) == (Count(2, 3), False)
    assert "not c" in told.words
    assert friction_at(said(), joints=("a",)).needed == Count(0, 1)


@pytest.mark.parametrize(
    ("value", "span", "right"),
    [
        (0.30, (0.29, 0.31), True),  # in range
        (0.40, (0.39, 0.41), False),  # out of range
        (0.40, (0.24, 0.56), True),  # out, but its interval reaches what is known
        (0.40, (-0.6, 1.4), False),  # as does one that holds everything
        (0.15, (0.14, 0.24), True),
    ],
)
def test_a_figure_is_right_in_range_or_by_its_interval(
    value: float, span: tuple[float, float], right: bool
) -> None:
    one = found("coulomb_friction", "a", figures={"level": value}, spans={"level": span})
    fact = partial(
        figures_at,
        effects=("coulomb_friction",),
        parameter="level",
        known={"a": (0.22, 0.25)},
        share=0.3,
    )
    told = fact(said(one))
    assert (told.needed, told.figures, told.agrees) == (Count(1, 1), Count(int(right), 1), right)


def test_a_cause_is_named_by_an_equivalent_too_and_only_at_its_joint() -> None:
    fact = partial(
        figures_at, effects=("coulomb_friction",), parameter="level", known={"a": (0.9, 1.1)}
    )
    listed = found("presliding_hysteresis", "a", equivalents=[{"effect": "coulomb_friction"}])
    assert fact(said(listed)).agrees
    assert fact(said(found("presliding_hysteresis", "a"))).needed == Count(0, 1)
    assert fact(said(found("coulomb_friction", "b"))).needed == Count(0, 1)
    silent = fact(said(), optional=True)
    assert (silent.agrees, silent.needed, silent.figures) == (True, Count(), Count())
    assert not fact(
        said(found("coulomb_friction", "a", figures={"level": 3.0})), optional=True
    ).agrees


@pytest.mark.parametrize(
    ("x", "y", "right"), [(0.0, 1.57, True), (0.0, -1.57, False), (0.5, 1.57, False)]
)
def test_a_tilt_has_a_direction(x: float, y: float, right: bool) -> None:
    one = found("gravity_direction", figures={"tilt_x": x, "tilt_y": y})
    told = tilt_about_y(said(one), least=80.0, most=100.0)
    assert (told.agrees, told.figures) == (right, Count(int(right), 1))


def test_delays_add_up_and_are_asked_for_at_every_joint() -> None:
    both = (
        found("command_delay", "a", figures={"delay": 0.05, "time_constant": 0.02}),
        found("actuator_lag", "a", figures={"time_constant": 0.03}),
    )
    told = delay_between(said(*both), joints=("a", "b"), least=0.09, most=0.11)
    assert (told.agrees, told.needed, told.figures) == (True, Count(1, 2), Count(1, 1))


def test_only_what_may_be_there_is_not_needless() -> None:
    findings = (found("coulomb_friction", "a"), found("torque_ripple", "a"))
    fact = partial(only, may=lambda each: each["effect"] == "coulomb_friction")
    assert fact(said(*findings)).wrong == {1}
    assert not fact(said(*findings)).agrees
    assert fact(said(*findings), needless=1).agrees


@pytest.mark.parametrize(
    ("one", "depends"),
    [
        (found("position_dependent_spring", "a"), True),
        (found("unknown", "a", figures={"variable": 0.0, "value_0": 1.0}), True),  # position
        (found("unknown", "a", figures={"variable": 3.0, "value_0": 1.0}), False),  # time
        (found("unknown", "a", "b", figures={"variable": 5.0}), False),  # another's position
        (found("position_dependent_spring", "b"), False),
    ],
)
def test_a_torque_of_position_may_be_nameless(one: dict[str, Any], depends: bool) -> None:
    assert depends_on_position(said(one), joint="a").agrees == depends


def test_frictions_that_look_alike_are_said_to() -> None:
    one = found("coulomb_friction", "a", equivalents=[{"effect": "viscous_friction"}])
    assert either_friction(said(one), joint="a").agrees
    assert either_friction(
        said(notes=["Coulomb and viscous friction look alike"]), joint="a"
    ).agrees
    assert not either_friction(said(found("coulomb_friction", "a")), joint="a").agrees


@pytest.mark.parametrize(
    ("diagnosis", "right"),
    [
        (refused("ValueError: q.joint1 jumps by 25 rad"), True),
        (said(verdict="cannot_tell", notes=["rec1.csv: the encoder wraps"]), True),
        (said(verdict="cannot_tell", notes=["joint1 moved too little"]), False),
        (refused("status 1: KeyError: 'jump'"), False),
        (said(notes=["q.joint1 jumps by 25 rad"]), False),
    ],
)
def test_a_refusal_must_say_why(diagnosis: dict[str, Any], right: bool) -> None:
    for machine_fact in list(stranger("wrapped_encoder").known.values())[:2]:
        told = machine_fact(diagnosis)
        assert (told.agrees, told.needed) == (right, Count(int(right), 1))


def test_held_out_residuals_are_counted_even_where_none_is_told() -> None:
    told = left_at_most(said(joints={"a": left(1.0, 0.1)}), most={"a": 0.2, "b": 0.2})
    assert (told.agrees, told.residuals) == (False, Count(1, 2))


def test_no_refusal_names_a_crash() -> None:
    fact = partial(or_refused, fact=partial(friction_at, joints=("a",)), why=("jump",))
    assert not fact(refused("no answer within 600 s: jump")).agrees


# What must not be


@pytest.mark.parametrize("effect", [e for e in CATALOGUE.values() if e.example], ids=lambda e: e.id)
def test_an_interval_contradicts_a_finding_where_it_holds_nothing(effect: Any) -> None:
    values = dict(effect.example.values)
    assert not holds_nothing(found(effect.id, "a", figures=values))
    wide = dict.fromkeys(values, (-1e3, 1e3))
    assert holds_nothing(found(effect.id, "a", figures=values, spans=wide))


def test_a_tilt_about_one_axis_is_not_contradicted_by_the_other() -> None:
    span = {"tilt_x": (-0.1, 0.1)}
    assert not holds_nothing(
        found("gravity_direction", figures={"tilt_x": 0.01, "tilt_y": 1.5}, spans=span)
    )


def test_what_is_not_called_sure_may_be_nothing() -> None:
    spans = {"level": (-1.0, 3.0)}
    sure, unsure = (found("coulomb_friction", "a", spans=spans, confidence=c) for c in (0.9, 0.89))
    assert len(broken(said(sure, unsure))) == 1
    assert broken(said(unsure)) == []


def test_a_joint_is_worse_by_more_than_rounding() -> None:
    joints = {"a": left(1.0, 1.0005), "b": left(1.0, 1.01), "c": left(0.0, 0.0)}
    assert [each.split(":")[0] for each in worse(said(joints=joints))] == ["b"]


@pytest.mark.parametrize(
    ("words", "is_crash"),
    [
        ("LoadError: no such file", False),
        ("ValueError: nothing moves", False),
        ("LinAlgError: singular matrix", True),
        ("status -11: nothing said", True),
        ("no answer within 600 s", True),
    ],
)
def test_a_refusal_is_no_crash(words: str, is_crash: bool) -> None:
    assert crashed(refused(words)) == is_crash
    assert not crashed(said())


def test_a_crash_agrees_with_nothing_that_is_known() -> None:
    for machine in MACHINES:
        told = machine.told(refused(WORDS))
        assert not any(each.agrees for each in told.values())
        assert all(each.needed.hits == 0 for each in told.values())


def test_a_finding_that_two_facts_call_wrong_is_wrong_once() -> None:
    one = said(found("payload", links=("tool",), figures={"mass": 2.0}))
    facts = [no_load_beyond(one, most=0.5), none_of(one, effects=("payload",))]
    count = tally(facts, one)
    assert (count.wrong, count.agree) == (1, Count(0, 2))
    assert (count + count).wrong == 2


def test_the_truth_agrees_with_what_is_known_of_the_arm_on_its_side() -> None:
    levels = {3: 0.26, 4: 0.51, 5: 0.17, 6: 0.48, 7: 0.105}
    offsets = {2: 0.6, 4: 0.4, 6: -0.28}
    truth = said(
        found("gravity_direction", figures={"tilt_x": -0.02, "tilt_y": np.radians(91.0)}),
        *(found("coulomb_friction", f"joint{k}", figures={"level": v}) for k, v in levels.items()),
        *(found("torque_offset", f"joint{k}", figures={"offset": v}) for k, v in offsets.items()),
        joints={
            f"joint{k}": left(9.0, each)
            for k, each in enumerate((0.27, 0.26, 0.13, 0.23, 0.07, 0.09, 0.03), 1)
        },
    )
    count = tally(stranger("arm_on_its_side").told(truth).values(), truth)
    assert count.agree == Count(5, 5)
    assert (count.needed, count.figures, count.residuals) == (Count(9, 9), Count(9, 9), Count(7, 7))
    assert count.wrong == 0


# Studies


@pytest.mark.parametrize("machine", MACHINES, ids=lambda each: each.name)
def test_a_machines_study_can_be_read(machine: Machine, tmp_path: Path) -> None:
    if not machine.recorded(RECORDINGS).is_dir():
        pytest.skip(f"needs {machine.recorded(Path('recordings'))} (PDOIK_SHARED or ../shared)")
    if machine.name == "go2_hanging" and not has_go2():
        pytest.skip("needs the Go2's URDF: pip install example-robot-data")
    write_study(machine, RECORDINGS, tmp_path / "study")
    study = load_study(tmp_path / "study" / "study.yaml")
    known = {
        joint
        for fact in machine.known.values()
        if isinstance(fact, partial)
        for each in ("known", "most", "joints")
        if isinstance(joints := fact.keywords.get(each, ()), dict | list | tuple)
        for joint in joints
    }
    assert known <= set(study.joints)


def test_machines_have_their_own_names() -> None:
    names = [machine.name for machine in MACHINES]
    assert len(set(names)) == len(names) == 10


# Tables


def test_two_tools_stand_beside_each_other() -> None:
    machines = [stranger("cable_at_a_wrist"), stranger("poor_serial_log")]
    good = {
        "diagnosis": said(
            found("position_dependent_spring", "joint1", figures={"stiffness": 0.02}),
            found("coulomb_friction", "joint1", figures={"level": 0.07}),
            joints={"joint1": left(0.09, 0.01)},
        ),
        "seconds": 2.0,
    }
    results = {each.name: {"before": CRASH, "after": good} for each in machines}
    text = report(machines, results, ["before", "after"], [stranger("wrapped_encoder")])
    assert "| needed causes named | 0 of 2 | 2 of 2 |" in text
    assert "| crashed | 2 | 0 |" in text
    assert "| cable_at_a_wrist | 0 of 2, 2 of 2 |" in text
    assert "status 1: OverflowError" in text
    assert "Skipped: no recordings/strangers/wrapped_encoder there." in text
    facts = "- command: python -m bench.sim2real.proof.real\n- commit: 1\n- processor: one\n"
    readme = "<!-- bench.sim2real.proof.real: Counted -->\n<!-- end -->"
    taken, count = published(f"{facts}- load before: 0.1\n\n{text}", readme)
    assert count == 1
    assert totals_table(machines, results, ["before", "after"]).strip() in taken


def test_without_recordings_all_machines_are_skipped(tmp_path: Path) -> None:
    assert "| crashed | 0 |" in real.diagnose_real(tmp_path, tmp_path / "out")
    assert (tmp_path / "out" / "real.md").read_text().count("Skipped: no ") == len(MACHINES)


def test_what_the_same_tool_said_of_the_same_study_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "recordings" / "strangers" / "wrapped_encoder"
    source.mkdir(parents=True)
    (source / "study.yaml").write_text("robot: robot.urdf\n")
    tool = tmp_path / "tool" / "pdoik" / "sim2real"
    tool.mkdir(parents=True)
    (tool / "one.py").write_text("")
    asked = []

    def blind(study: Path, tool: Path | None) -> dict[str, Any]:
        asked.append(tool)
        return dict(CRASH)

    monkeypatch.setattr(real, "blind", blind)
    ask = partial(
        real.diagnose_real,
        tmp_path / "recordings",
        tmp_path / "out",
        {"before": None, "after": tool.parents[1]},
    )
    for changed, times in ((False, 2), (False, 2), (True, 3)):
        if changed:
            (tool / "one.py").write_text("changed = True\n")
        assert "| crashed | 1 | 1 |" in ask()
        assert len(asked) == times
    assert asked[0] is None
    assert asked[1] is not None
    assert asked[1] != tool.parents[1]  # a copy, which nobody changes meanwhile
    kept = json.loads((tmp_path / "out/real/after/wrapped_encoder.json").read_text())
    assert kept["error"] == WORDS
