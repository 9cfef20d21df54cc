"""The verdict in one word, and what has no name, from the joints' residuals."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects.simulated import not_simulated, parts_of_finding
from pdoik.sim2real.findings import Finding, JointFit
from pdoik.sim2real.infer.verdict import verdict_of, what_is_left
from pdoik.sim2real.model.model import Model


def joint(before: float, after: float, *, floor: float = 0.1, excited: bool = True) -> JointFit:
    return JointFit(
        before=before, after=after, noise_floor=floor, unit="N m", data="run", excited=excited
    )


MOTION = SimpleNamespace(source="tau")
STUDY: Any = SimpleNamespace(  # what is asked of a prepared study here
    study=SimpleNamespace(joints=("a", "b", "c")), fit=SimpleNamespace(motions=[MOTION])
)
FRICTION = Finding(effect="coulomb_friction", joints=("a",))


@pytest.mark.parametrize(
    ("findings", "joints", "verdict"),
    [
        ((), {"a": joint(0.1, 0.1), "b": joint(0.11, 0.11)}, "no_mismatch"),
        ((), {"a": joint(0.1, 0.1), "b": joint(0.1, 0.1, excited=False)}, "cannot_tell"),
        ((), {"a": joint(0.1, 0.1), "b": joint(5.0, 5.0, excited=False)}, "cannot_tell"),
        ((), {"a": joint(0.1, 0.1, excited=False)}, "cannot_tell"),
        ((), {"a": joint(2.0, 2.0), "b": joint(0.1, 0.1)}, "mismatch_unexplained"),
        (
            (),
            {"a": joint(2.0, 2.0), "b": joint(0.1, 0.1, excited=False)},
            "mismatch_unexplained",
        ),
        ((FRICTION,), {"a": joint(2.0, 0.11), "b": joint(0.1, 0.1)}, "mismatch_explained"),
        ((FRICTION,), {"a": joint(2.0, 0.9), "b": joint(0.1, 0.1)}, "mismatch_partly_explained"),
    ],
)
def test_the_verdict(
    findings: tuple[Finding, ...], joints: dict[str, JointFit], verdict: str
) -> None:
    assert verdict_of(findings, joints) == verdict


def test_much_that_is_left_at_a_joint_is_a_finding_without_a_name() -> None:
    joints = {"a": joint(2.0, 1.5), "b": joint(2.0, 0.2), "c": joint(0.1, 0.1)}
    (left,) = what_is_left(STUDY, (FRICTION,), joints)
    assert (left.effect, left.joints, left.variant) == ("unknown", ("a",), "left")
    assert left.values == {"left": 1.5}
    assert left.evidence.channels == ("tau",)
    assert "nothing the catalogue knows" in left.statement


def test_what_a_joint_that_stood_still_leaves_is_nobodys_finding() -> None:
    assert what_is_left(STUDY, (), {"a": joint(2.0, 2.0, excited=False)}) == ()


def test_what_already_has_a_law_is_not_told_twice() -> None:
    told = Finding(effect="unknown", joints=("a",), variant="")
    assert what_is_left(STUDY, (told,), {"a": joint(2.0, 1.5)}) == ()


def test_what_is_left_survives_the_models_file_and_adds_no_torque() -> None:
    (left,) = what_is_left(STUDY, (), {"a": joint(2.0, 1.5)})
    assert not_simulated(left)
    assert parts_of_finding(left) == ()
    model = Model(joints=("a",), findings=(left,))
    assert Model.from_json(model.to_json()).findings == (left,)
