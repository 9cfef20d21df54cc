"""What an installed pdoik does where nothing of its sources is: solve, follow, fit, diagnose, view.

python tests/wheel/smoke.py            with NumPy alone: solve, follow
python tests/wheel/smoke.py all        with the extra all: the others, too
"""

from __future__ import annotations

import sys
import tempfile
import threading
import urllib.request
from pathlib import Path

import numpy as np

import pdoik

PENDULUM = """<robot name="pendulum">
  <link name="base"/>
  <joint name="swing" type="revolute">
    <parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="20" velocity="10"/>
  </joint>
  <link name="rod">
    <inertial><origin xyz="0 0 -0.3"/><mass value="1.5"/>
      <inertia ixx="0.02" iyy="0.02" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 -0.15"/><geometry><box size="0.04 0.04 0.3"/></geometry></collision>
  </link>
</robot>
"""


def solve_and_follow() -> None:
    robot = pdoik.Robot.builtin("panda")
    target = robot.fk(robot.mid_configuration())
    cloud = np.random.default_rng(0).uniform(1.0, 2.0, (500, 3))
    solver = pdoik.Solver(robot)
    solved = solver.solve(target, obstacles=pdoik.Cloud(pdoik.voxel_downsample(cloud, 0.05)))
    assert solved.success
    assert np.abs(robot.fk(solved.q) - target).max() < 1e-3
    tracker = pdoik.Tracker(solver, period=0.001)
    tracker.reset(solved.q)
    assert np.abs(tracker.step(target).q - solved.q).max() < 0.1


def fit(urdf: Path) -> None:
    from pdoik.occupancy_fit import fit_occupancy

    fitted = fit_occupancy(urdf)
    fitted.write(urdf.with_suffix(".occupancy.yaml"))
    pdoik.Occupancy.load(urdf.with_suffix(".occupancy.yaml"))


def diagnose(urdf: Path) -> None:
    """A pendulum with friction that its description leaves out."""
    from pdoik import sim2real

    names = []
    for k, speed in enumerate((1.0, 1.37)):
        t = np.arange(0, 30, 0.005)
        w = speed * np.array([[0.7], [1.9], [3.3]])
        size, phase = np.array([[0.8], [0.3], [0.1]]), np.array([[k], [0.4], [2.0]])
        q = (size * np.sin(w * t + phase)).sum(axis=0)
        dq = (size * w * np.cos(w * t + phase)).sum(axis=0)
        ddq = (-size * w * w * np.sin(w * t + phase)).sum(axis=0)
        tau = (0.02 + 1.5 * 0.3**2) * ddq + 1.5 * 9.81 * 0.3 * np.sin(q)
        tau += 0.6 * np.tanh(dq / 0.01) + np.random.default_rng(k).normal(0, 0.02, len(t))
        names.append(f"swing{k}.csv")
        np.savetxt(
            urdf.parent / names[-1],
            np.column_stack([t, q, dq, tau]),
            delimiter=",",
            header="time,q.swing,dq.swing,tau.swing",
            comments="",
        )
    study = urdf.parent / "study.yaml"
    study.write_text(f"robot: {urdf.name}\nrecordings: [{', '.join(names)}]\n")
    found = sim2real.diagnose(study).findings
    assert [each.effect for each in found][:1] == ["coulomb_friction"], found


def view(urdf: Path) -> None:
    """The page, as `pdoik view` serves it."""
    import re
    import subprocess

    command = [sys.executable, "-m", "pdoik.cli", "view", "panda", "--no-open", "--port", "0"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as p:
        stop = threading.Timer(60, p.kill)
        stop.start()
        assert p.stdout is not None
        address = ""
        for line in p.stdout:
            told = re.search(r"http://[\w.:]+", line)
            if told:
                address = told[0]
                break
        with urllib.request.urlopen(address, timeout=20) as page:
            assert b"<html" in page.read().lower()
        stop.cancel()
        p.kill()


def main() -> None:
    solve_and_follow()
    done = ["solve", "follow"]
    if sys.argv[1:] == ["all"]:
        with tempfile.TemporaryDirectory() as folder:
            urdf = Path(folder) / "pendulum.urdf"
            urdf.write_text(PENDULUM)
            for part in (fit, diagnose, view):
                part(urdf)
                done.append(part.__name__)
    print(
        f"pdoik {pdoik.__version__}, Python {sys.version.split()[0]}: {', '.join(done)}: all well"
    )


if __name__ == "__main__":
    main()
