"""What the command line says of a diagnosis: what joints share, what is anomalous, in few lines."""

from __future__ import annotations

import pytest

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.cli.diagnose import print_diagnosis
from pdoik.sim2real import Diagnosis, Equivalent, Estimate, Finding, JointFit, Residue
from pdoik.sim2real.report import matrix_of

JOINTS = tuple(f"joint{k}" for k in range(1, 13))


def found(effect: str, joint: str, value: float, unit: str, **more: object) -> Finding:
    estimate = Estimate(value=value, std=0.01, interval95=(value - 0.02, value + 0.02), unit=unit)
    return Finding(effect=effect, joints=(joint,), parameters={"figure": estimate}, **more)  # type: ignore[arg-type]


def rubbing() -> Diagnosis:
    """Every joint rubs, two are late, one has a spring and some more."""
    findings = [found("coulomb_friction", joint, 0.3, "N m") for joint in JOINTS]
    findings += [found("command_delay", joint, 0.02, "s") for joint in JOINTS[:2]]
    findings += [
        found("torque_ripple", joint, 0.2, "N m", equivalents=(Equivalent(effect="backlash"),),
              decided_by="slow constant speed")
        for joint in JOINTS[3:4]
    ]  # fmt: skip
    findings += [found(f"effect_{k}", "joint5", 1.0, "-") for k in range(9)]
    fit = JointFit(before=2.0, after=0.1, noise_floor=0.1, unit="N m", data="run", excited=True)
    left = JointFit(
        before=2.0, after=1.0, noise_floor=0.1, unit="N m", data="run", excited=True,
        residue=Residue(of="load", share=0.5),
    )  # fmt: skip
    return Diagnosis(
        verdict="mismatch_partly_explained",
        findings=tuple(findings),
        joints={joint: left if joint == "joint9" else fit for joint in JOINTS},
    )


def test_what_several_joints_have_is_a_column_and_the_rest_is_peculiar() -> None:
    matrix = matrix_of(rubbing())
    assert matrix.effects == ("coulomb_friction", "command_delay")
    assert list(matrix.cells["joint1"]) == ["coulomb_friction", "command_delay"]
    assert list(matrix.cells["joint3"]) == ["coulomb_friction"]
    assert [finding.effect for finding in matrix.others[:2]] == ["torque_ripple", "effect_0"]


def test_the_command_line_says_it_in_25_lines(capsys: pytest.CaptureFixture[str]) -> None:
    print_diagnosis(rubbing())
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 25
    (head,) = (line for line in lines if "[N m]" in line)
    assert "[s]" in head
    (row,) = (line for line in lines if line.lstrip().startswith("joint9 "))
    assert "0.300±0.020" in row
    assert row.rstrip().endswith("unexplained, 50 % by load")
    assert any(line.startswith("torque ripple at joint4: figure 0.200 N m") for line in lines)
    assert "... and" in lines[-2]
    assert lines[-1] == "What would decide: slow constant speed"
