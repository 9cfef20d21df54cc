"""The verdict in one word, and what has no name, from the joints' residuals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real import Diagnosis, Finding, JointFit, Residue, prepare
from pdoik.sim2real.infer import residue_of, verdict_of
from pdoik.sim2real.report import residue_words
from sim2real_channels import study


def joint(before: float, after: float, *, floor: float = 0.1, excited: bool = True) -> JointFit:
    return JointFit(
        before=before, after=after, noise_floor=floor, unit="N m", data="run", excited=excited
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


def test_what_happened_in_the_fit_recordings_alone_is_not_passed_over() -> None:
    fine, left = {"a": joint(2.0, 0.1)}, {"a": joint(2.0, 1.5)}
    assert verdict_of((FRICTION,), fine, fine) == "mismatch_explained"
    assert verdict_of((FRICTION,), fine, left) == "mismatch_partly_explained"
    assert verdict_of((), {"a": joint(0.1, 0.1)}, left) == "mismatch_unexplained"


@pytest.mark.parametrize("of", ["speed", "position", "load", "time"])
def test_what_is_left_of_a_joint_is_placed(tmp_path: Path, of: str) -> None:
    prepared = prepare(study(tmp_path, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    b, key = prepared.fit, ("torque", 1)
    by = {
        "speed": b.sampled([m.dq[:, 1] for m in b.motions]),
        "position": b.sampled([m.q[:, 1] for m in b.motions]),
        "load": b.sampled([m.tau[:, 1] for m in b.motions]),
        "time": b.time,
    }[of]
    law = np.sin(3.0 * (by - by.mean()) / by.std())
    noise = np.random.default_rng(1).standard_normal(len(law))
    residue = residue_of(b, key, law + 0.5 * noise)
    assert residue.of == of
    assert residue.share == pytest.approx(0.5 / 0.75, abs=0.15)
    assert residue_of(b, key, noise) == Residue()


def test_a_residue_survives_the_diagnosis_file() -> None:
    left = replace(joint(2.0, 1.5), residue=Residue(of="speed", share=0.6))
    found = Diagnosis(verdict="mismatch_unexplained", findings=(), joints={"a": left})
    assert Diagnosis.from_json(found.to_json()) == found
    assert residue_words(left) == "unexplained, 60 % by speed"
    assert residue_words(joint(2.0, 0.1)) == ""
