"""Studies of concealed worlds, and another library's opinion of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import yaml
from scipy import signal

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import Truth, WorldSpec

DERIVATIVES = 20.0  # [Hz] up to which positions are differentiated
BOTH_SIDES = 6.0  # [Hz] of the filter on torque and model alike
STEP = 0.004  # [s]


class Judge:
    """Reads a study folder as a stranger would and asks Pinocchio what the torques should be."""

    def __init__(self, folder: Path, truth: Truth) -> None:
        self.study = yaml.safe_load((folder / "study.yaml").read_text())
        self.model = pin.buildModelFromUrdf(str(folder / "robot.urdf"))
        self.joints = [str(name) for name in self.model.names][1:]
        armature = dict(zip(self.study["joints"], self.study["rotor_inertia"], strict=True))
        self.armature = np.array([armature[name] for name in self.joints])
        noise = dict(zip(truth.joints, truth.noise["tau"], strict=True))
        self.noise = np.array([noise[name] for name in self.joints])
        self.folder = folder

    def motion(self, file: str) -> dict[str, np.ndarray]:
        """Filtered positions, their derivatives and torques on an even grid, ends cut off."""
        text = self.folder / file
        names = text.read_text().split("\n", 1)[0].split(",")
        table = np.loadtxt(text, delimiter=",", skiprows=1)
        time = np.arange(table[0, 0], table[-1, 0], STEP)
        low_pass = signal.butter(3, DERIVATIVES, fs=1.0 / STEP, output="sos")

        def channel(name: str) -> np.ndarray:
            columns = [
                np.interp(time, table[:, 0], table[:, names.index(f"{name}.{joint}")])
                for joint in self.joints
            ]
            return signal.sosfiltfilt(low_pass, np.column_stack(columns), axis=0)

        q = channel("q")
        dq = np.gradient(q, STEP, axis=0)
        ddq = np.gradient(dq, STEP, axis=0)
        cut = slice(150, -150)
        return {
            "time": time[cut],
            "q": q[cut],
            "dq": dq[cut],
            "ddq": ddq[cut],
            "tau": channel("tau")[cut],
        }

    def residual(self, file: str, model: object | None = None) -> tuple[dict, np.ndarray]:
        """Motion and torque less inverse dynamics, (T, n)."""
        model = self.model if model is None else model
        motion, data = self.motion(file), model.createData()
        believed = np.array(
            [
                pin.rnea(model, data, q, dq, ddq) + self.armature * ddq
                for q, dq, ddq in zip(motion["q"], motion["dq"], motion["ddq"], strict=True)
            ]
        )
        low_pass = signal.butter(3, BOTH_SIDES, fs=1.0 / STEP, output="sos")
        return motion, signal.sosfiltfilt(low_pass, motion["tau"] - believed, axis=0)

    def index(self, truth: Truth) -> int:
        """The hidden effect's joint."""
        return self.joints.index(truth.effects[0]["joints"][0])

    @property
    def files(self) -> list[str]:
        return [recording["file"] for recording in self.study["recordings"]]


def made(folder: Path, **fields: object) -> tuple[Judge, Truth]:
    truth = make_study(folder, WorldSpec(**{"seed": 7, **fields}))
    return Judge(folder, truth), truth


def rms(values: np.ndarray) -> np.ndarray:
    return np.sqrt(np.mean(values**2, axis=0))
