"""Effects that begin in the middle of a recording, told from another day's friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from pdoik.sim2real import diagnose

URDF = """<robot name="r"><link name="base"/>
<link name="l1"><inertial><origin xyz="0 0 -0.3"/><mass value="4"/>
<inertia ixx="0.05" iyy="0.05" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="60" velocity="4"/></joint></robot>"""


def recorded(seed: int, level) -> dict[str, np.ndarray]:
    """One joint's sines with friction of `level(time)`, exactly by its equation."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 30.0, 0.005)
    q, dq, ddq = np.zeros((3, len(t)))
    for rate in (0.7, 1.3, 2.1):
        a, phase = rng.uniform(0.2, 0.5), rng.uniform(0.0, 6.0)
        q += a * np.sin(rate * t + phase)
        dq += a * rate * np.cos(rate * t + phase)
        ddq -= a * rate**2 * np.sin(rate * t + phase)
    tau = (0.05 + 4 * 0.09) * ddq + 4 * 9.81 * 0.3 * np.sin(q)
    tau += level(t) * np.tanh(dq / 0.01) + rng.normal(0.0, 0.05, len(t))
    return {"time": t, "q.j1": q + rng.normal(0.0, 2e-5, len(t)), "dq.j1": dq, "tau.j1": tau}


def written(folder: Path, levels) -> Path:
    (folder / "r.urdf").write_text(URDF)
    for k, level in enumerate(levels):
        columns = recorded(k, level)
        table = np.column_stack(list(columns.values()))
        header = ",".join(columns)
        np.savetxt(folder / f"rec{k + 1}.csv", table, "%.7g", ",", header=header, comments="")
    entries = [{"file": f"rec{k + 1}.csv", "role": "fit"} for k in range(len(levels))]
    entries[-1]["role"] = "validate"
    study = {"robot": "r.urdf", "joints": ["j1"], "recordings": entries}
    (folder / "study.yaml").write_text(yaml.safe_dump(study))
    return folder / "study.yaml"


def test_friction_that_begins_in_a_recording_is_told_with_its_moment(tmp_path: Path) -> None:
    def seal(t):
        return 1.0 + 3.0 * (t > 14.0)

    levels = [lambda t: 1.0 + 0 * t, seal, lambda t: 4.0 + 0 * t, lambda t: 4.0 + 0 * t]
    found = diagnose(written(tmp_path, levels)).findings
    late = [each for each in found if each.begins is not None]
    (finding,) = late
    assert finding.effect in ("coulomb_friction", "presliding_hysteresis")
    assert finding.begins[0] == "rec2.csv"
    assert finding.begins[1] == pytest.approx(14.0, abs=0.5)
    assert finding.recordings == ("rec2.csv", "rec3.csv")
    assert finding.values["level"] == pytest.approx(3.0, rel=0.1)
    assert "since 14" in finding.statement
    assert finding.gate is None  # a model of the machine as it is now has it always


def test_another_days_friction_is_no_onset(tmp_path: Path) -> None:
    levels = [lambda t, v=v: v + 0 * t for v in (1.0, 1.4, 1.4, 1.2)]
    found = diagnose(written(tmp_path, levels)).findings
    assert [each.effect for each in found if each.begins is not None] == []
