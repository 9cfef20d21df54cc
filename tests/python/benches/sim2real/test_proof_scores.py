"""The scores of the proof, on truths and findings made up for it, and what is made of them."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")
pytest.importorskip("dask")
pytest.importorskip("pyarrow")
pytest.importorskip("matplotlib")

from bench.sim2real.concealed.score import scores
from bench.sim2real.frame.sealed import append_record, record
from bench.sim2real.proof import confusion, failures, reach, run
from bench.sim2real.proof.score import score

# How it is scored


def found(effect: str, *joints: str, links: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    rest = {"equivalents": [], "parameters": {}, "window": None, "recordings": [], "variant": ""}
    evidence = {"validation_gain": 0.5, "interval95": [0.4, 0.6]}
    return {
        "effect": effect,
        "joints": list(joints),
        "links": list(links),
        "evidence": evidence,
        **rest,
        **more,
    }


def hidden(effect: str, *joints: str, links: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    rest = {"recordings": None, "window": None, "position_window": None, "kind": None}
    return {
        "effect": effect,
        "joints": list(joints),
        "links": list(links),
        "parameters": {},
        "role": "hidden",
        "channel": None,
        **rest,
        **more,
    }


def names(*effects: str) -> list[dict[str, Any]]:
    return [{"effect": each, "joints": [], "links": []} for each in effects]


def fit(before: float, after: float, floor: float = 1.0, excited: bool = True) -> dict[str, Any]:
    return {
        "before": before,
        "after": after,
        "noise_floor": floor,
        "excited": excited,
        "unit": "N m",
    }


def scored(
    truth: list[dict[str, Any]],
    findings: list[dict[str, Any]],
    *,
    effect: str | None = None,
    hide: str = "plain",
    verdict: str = "mismatch_explained",
    joints: dict[str, Any] | None = None,
    notes: tuple[str, ...] = (),
    still: tuple[str, ...] = (),
    true: dict[str, float] | None = None,
) -> dict[str, Any]:
    """A row of a robot with three joints."""
    spec = {"seed": 1, "effect": effect or truth[0]["effect"], "hide": hide, "robot": "random3"}
    content = {
        "spec": spec,
        "effects": truth,
        "joints": ["joint2", "joint1", "joint3"],
        "still": list(still),
        "corner": "",
        "size": 7.0,
    }
    diagnosis = {
        "verdict": verdict,
        "findings": findings,
        "joints": joints or {f"joint{k}": fit(3.0, 1.0) for k in (1, 2, 3)},
        "notes": list(notes),
    }
    said = {"diagnosis": diagnosis, "seconds": 1.0, "process_seconds": 2.0}
    return score("study0001", content, said, true or {})


def test_a_name_at_its_place_is_right_and_elsewhere_is_not() -> None:
    right = scored([hidden("viscous_friction", "joint1")], [found("viscous_friction", "joint1")])
    assert (right["named"], right["listed"], right["placed"]) == (True, True, True)
    assert (right["answer"], right["extra"]) == ("named", 0)
    wrong = scored([hidden("viscous_friction", "joint1")], [found("viscous_friction", "joint2")])
    assert wrong["named"]
    assert not wrong["placed"]
    assert wrong["answer"] == "wrong"
    assert failures.class_of(SimpleNamespace(**wrong)) == "viscous_friction: in the wrong place"


def test_three_equivalents_count_and_a_fourth_does_not() -> None:
    truth = [hidden("backlash", "joint1")]
    few = names("actuator_lag", "rotor_inertia", "backlash")
    for listed, equivalents in ((True, few), (False, [*names("torque_gain"), *few])):
        row = scored(truth, [found("joint_elasticity", "joint1", equivalents=equivalents)])
        assert not row["named"]
        assert row["listed"] is listed


def test_delay_and_lag_are_one_name_and_of_links_only_the_last_is_a_payloads() -> None:
    assert scored([hidden("actuator_lag", "joint1")], [found("command_delay", "joint1")])["named"]
    for link, same in (("link3", True), ("link2", False)):
        truth = [hidden("link_inertial_error", links=(link,))]
        assert scored(truth, [found("payload", links=("link3",))])["named"] is same
        assert scored(truth, [found("link_inertial_error", links=(link,))])["named"]


def test_what_stands_beside_is_no_finding_too_many_and_lends_no_equivalent() -> None:
    second = hidden("coulomb_friction", "joint3", role="second")
    truth = [hidden("torque_gain", "joint1"), second]
    other = found("coulomb_friction", "joint3", equivalents=names("torque_gain"))
    missed = scored(truth, [other])
    assert (missed["named"], missed["listed"], missed["first"]) == (False, False, "nothing")
    both = scored(truth, [other, found("torque_gain", "joint1")])
    assert both["named"]
    assert both["extra"] == 0
    more = scored(truth, [other, found("torque_gain", "joint1"), found("torque_offset", "joint1")])
    assert more["extra"] == 1


def test_a_window_that_is_told_must_be_the_hidden_one_and_one_untold_is_counted() -> None:
    truth = [hidden("viscous_friction", "joint1", window=[14.0, 60.0])]
    for window, placed, told in (
        ([13.8, 24.0], True, True),
        ([2.0, 9.0], False, False),
        (None, True, False),
    ):
        row = scored(truth, [found("viscous_friction", "joint1", window=window)])
        assert (row["placed"], row["window_told"]) == (placed, told)
        assert row["window_hidden"]
    where = [hidden("viscous_friction", "joint1", position_window=[0.0, 1.0])]
    row = scored(where, [found("viscous_friction", "joint1", positions=[0.1, 1.0])])
    assert row["window_told"]
    contact = [hidden("external_contact", links=("link3",), recordings=["a"], window=[1.0, 3.0])]
    row = scored(contact, [found("external_contact", links=("link3",), recordings=["a"])])
    assert not row["placed"]  # a contact without its window is nowhere


def test_parameters_count_inside_their_intervals_at_the_right_place_only() -> None:
    estimate = {"value": 1.05, "std": 0.03, "interval95": [0.99, 1.11], "unit": "N m"}
    truth = [hidden("coulomb_friction", "joint1", parameters={"level": 1.0})]
    for joint, intervals in (("joint1", 1), ("joint2", 0)):
        said = found("coulomb_friction", joint, parameters={"level": estimate})
        row = scored(truth, [said])
        assert (row["inside"], row["intervals"]) == (intervals, intervals)


def test_the_residual_left_is_held_against_the_true_models() -> None:
    truth = [hidden("coulomb_friction", "joint1")]
    joints = {"joint1": fit(5.0, 1.8), "joint2": fit(1.2, 1.2), "joint3": fit(1.0, 1.0)}
    row = scored(truth, [], joints=joints, true={"joint1": 1.2, "joint2": 0.1, "joint3": 0.1})
    assert row["over_true"] == pytest.approx(1.5)  # joint 1 alone shows what is hidden
    assert not row["by_floor"]
    without = scored(truth, [], joints=joints)
    assert without["over_true"] == pytest.approx(1.8)
    assert without["by_floor"]


def test_a_finding_or_a_mismatch_where_nothing_is_wrong_is_a_false_alarm() -> None:
    quiet = scored([], [], effect="clean", verdict="no_mismatch")
    assert (quiet["answer"], quiet["alarm"]) == ("no mismatch", False)
    for findings, verdict in (
        ([found("backlash", "joint1")], "mismatch_explained"),
        ([], "mismatch_unexplained"),
        ([], "error: LoadError: is 'q' in deg?"),
    ):
        loud = scored([], findings, effect="clean", verdict=verdict)
        assert (loud["answer"], loud["alarm"]) == ("wrong", True)
    unsure = scored([], [], effect="clean", verdict="cannot_tell")
    assert (unsure["answer"], unsure["alarm"]) == ("wrong", False)


@pytest.mark.parametrize(
    ("findings", "verdict", "right"),
    [
        ([], "mismatch_unexplained", True),
        ([found("unknown", "joint1")], "mismatch_unexplained", True),
        (
            [found("viscous_friction", "joint1"), found("unknown", "joint1")],
            "mismatch_partly_explained",
            True,
        ),
        (
            [found("viscous_friction", "joint1"), found("unknown", "joint2")],
            "mismatch_partly_explained",
            False,
        ),
        ([found("viscous_friction", "joint1")], "mismatch_partly_explained", False),
        ([found("viscous_friction", "joint1")], "mismatch_explained", False),
        ([], "no_mismatch", False),
        ([], "cannot_tell", False),
    ],
)
def test_physics_outside_the_catalogue_must_be_called_unknown(
    findings: list[dict[str, Any]], verdict: str, right: bool
) -> None:
    truth = [hidden("unknown", "joint1", kind="outside")]
    row = scored(truth, findings, effect="outside:pump", verdict=verdict)
    assert row["right"] is right


def lie(kind: str, channel: str, *joints: str) -> list[dict[str, Any]]:
    return [hidden("lying_channel", *joints, kind=kind, channel=channel)]


def test_a_lying_channel_must_be_the_one_that_is_blamed() -> None:
    def told(truth: list[dict[str, Any]], findings: list[dict[str, Any]], **said: Any) -> bool:
        return bool(scored(truth, findings, effect=f"lying:{truth[0]['kind']}", **said)["right"])

    sign = lie("tau_sign", "tau", "joint1")
    assert told(sign, [found("sensor_gain", "joint1")])
    assert told(sign, [found("torque_gain", "joint1")])
    assert not told(sign, [found("sensor_gain", "joint2")])
    assert not told(sign, [found("sensor_gain", "joint1", variant="position")])
    assert not told(sign, [found("payload", links=("link3",))])
    assert told(sign, [], notes=("tau.joint1 was divided by -1 before all else was judged.",))
    assert not told(sign, [], notes=("tau.joint3 was divided by -1.",))
    speed = lie("dq_scaled", "dq", "joint1")
    assert told(speed, [found("sensor_gain", "joint1", variant="logged speed")])
    assert told(speed, [], verdict="error: LoadError: rec1.csv: is 'dq' in deg/s? Expected rad/s")
    assert not told(speed, [], verdict="error: LoadError: rec1.csv: is 'q' in deg? Expected rad")
    model = lie("tau_model", "tau", "joint1", "joint2", "joint3")
    assert told(model, [], notes=("tau is no measurement: it is the model's own torque",))
    assert not told(model, [], notes=("joint1: moved too little to be judged.",))


def test_a_joint_at_rest_must_not_be_judged() -> None:
    rest = {"joint1": fit(1.0, 1.0, excited=False), "joint2": fit(1.0, 1.0)}
    moves = {"joint1": fit(1.0, 1.0), "joint2": fit(1.0, 1.0)}
    for joints, findings, right in (
        (rest, [], True),
        (moves, [], False),
        (rest, [found("coulomb_friction", "joint1")], False),
    ):
        row = scored(
            [],
            findings,
            effect="still",
            still=("joint1",),
            joints=joints,
            verdict="no_mismatch",
        )
        assert row["right"] is right


def test_poor_motion_is_answered_by_the_name_or_by_saying_that_it_cannot_be_told() -> None:
    truth = [hidden("viscous_friction", "joint1")]
    rest = {"joint1": fit(1.0, 1.0, excited=False), "joint2": fit(1.0, 1.0)}
    moves = {"joint1": fit(1.0, 1.0), "joint2": fit(1.0, 1.0)}
    cases = [
        ([found("viscous_friction", "joint1")], "mismatch_explained", moves, "named"),
        ([], "cannot_tell", moves, "not judged"),
        ([], "no_mismatch", rest, "not judged"),
        ([], "no_mismatch", moves, "wrong"),
        ([found("payload", links=("link3",))], "mismatch_explained", rest, "wrong"),
    ]
    for findings, verdict, joints, answer in cases:
        row = scored(
            truth,
            findings,
            hide="poor",
            verdict=verdict,
            joints=joints,
            still=("joint1",),
        )
        assert row["answer"] == answer
        assert row["right"] is (answer != "wrong")
        assert row["listed_or_right"] is (answer != "wrong")


def test_a_payload_is_found_at_the_last_link() -> None:
    truth = {"effects": [hidden("payload", links=("link3",))], "joints": ["a", "b", "c"]}
    said = {"verdict": "", "findings": [found("payload", links=("link3",))], "joints": {}}
    row = scores(truth, said)
    assert row["named"]
    assert row["placed"]


# What is made of the scores


@pytest.fixture(scope="module")
def studies() -> pd.DataFrame:
    truth = [hidden("backlash", "joint1")]
    rows = [scored(truth, [found("backlash", "joint1")]) for _ in range(3)]
    rows += [scored(truth, [found("joint_elasticity", "joint1")], hide="noise") for _ in range(2)]
    rows.append(scored(truth, [], hide="poor", verdict="no_mismatch"))
    rows += [scored([], [], effect="clean", verdict="no_mismatch") for _ in range(4)]
    rows.append(scored([], [found("backlash", "joint2")], effect="clean"))
    return pd.DataFrame(rows).assign(why_not="")


def test_what_was_asked_stands_beside_what_came(studies: pd.DataFrame) -> None:
    values = {each.what: (reach.reached(studies, each), each) for each in reach.ASKED}
    (value, _, total), asked = values["plain: named first"]
    assert (value, total, reach.verdict(value, asked)) == (1.0, 3, "PASS")
    (value, _, total), asked = values["all ways but poor: named or equivalent"]
    assert (value, total, reach.verdict(value, asked)) == (0.6, 5, "MISS")
    (value, _, total), asked = values["false alarms on clean studies"]
    assert (value, total, reach.verdict(value, asked)) == (0.2, 5, "MISS")
    (value, _, total), asked = values["unknown recognised"]
    assert total == 0
    assert reach.verdict(value, asked) == "none"


def test_failures_have_pages_with_the_most_frequent_first(
    studies: pd.DataFrame, tmp_path: Path
) -> None:
    assert failures.write_pages(studies, tmp_path / "failures") == 4
    index = (tmp_path / "failures" / "README.md").read_text()
    assert "4 of 11 studies" in index
    first = next(line for line in index.splitlines() if line.startswith("| ["))
    assert "backlash: said joint elasticity" in first
    assert "noise 2" in first
    pages = sorted(path.name for path in (tmp_path / "failures").iterdir())
    assert "backlash-said-joint-elasticity.md" in pages
    page = (tmp_path / "failures" / "backlash-said-joint-elasticity.md").read_text()
    assert "hidden  backlash joint1" in page
    assert "found   joint_elasticity joint1" in page


def test_the_picture_counts_what_was_said_first(studies: pd.DataFrame, tmp_path: Path) -> None:
    table = confusion.counts(studies)
    assert table.loc["backlash", "backlash"] == 3
    assert table.loc["backlash", "joint_elasticity"] == 2
    assert table.loc["nothing wrong", "nothing"] == 4
    assert table.to_numpy().sum() == 10  # poor motion is not in it
    confusion.draw(studies, tmp_path / "confusion.png")
    assert (tmp_path / "confusion.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_the_record_keeps_every_run_once_and_knows_the_earlier_ones(
    studies: pd.DataFrame, tmp_path: Path
) -> None:
    path, digests = tmp_path / "record.jsonl", {"tool": "a"}
    written = {"sealed_at": "now", "seed": 1, "count": 2, "truths": "t", "studies": "s"}
    written |= {"not_made": [], "digests": digests}
    assert record(path) == []
    assert append_record(path, run.record_line("sealed", written))
    assert append_record(path, run.scored_line(written, "b", studies))
    assert not append_record(path, run.scored_line(written, "b", studies))
    lines = record(path)
    assert [line["event"] for line in lines] == ["sealed", "scored"]
    assert lines[1]["scores"]["plain: named first"]["verdict"] == "PASS"
    assert lines[1]["truths"] == written["truths"]
    assert run.earlier_runs(written, path) == []
    again = {**written, "sealed_at": "later"}
    assert len(run.earlier_runs(again, path)) == 2
    assert run.earlier_runs({**again, "digests": {"tool": "c"}}, path) == []
