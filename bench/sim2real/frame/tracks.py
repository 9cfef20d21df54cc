"""What every method is given: smoothed motions and torques of recordings, and the model."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy import signal

from pdoik.cli.motions import read_motion
from pdoik.sim2real import Recording, Study

Array = NDArray[np.float64]

CUTOFF = 10.0  # of all filters, run forwards and backwards [Hz]
REST = 0.02  # speed at which a sign has almost all its size [rad/s]
ENDS = 0.5  # left out at both ends, where filters swing [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """One recording on a uniform grid, smoothed, with what the user's model says of it."""

    recording: Recording
    period: float  # [s]
    q: Array  # (T, n) [rad]
    dq: Array  # (T, n)
    ddq: Array  # (T, n)
    tau: Array  # (T, n) measured, smoothed likewise [N m]
    model: Array  # (T, n) by the URDF that goes with the recording, rotors included [N m]
    load: Array  # (T, n) of these the torque of a load that is known to all [N m]
    urdf: Path  # that goes with the recording

    @property
    def residual(self) -> Array:
        """What the model leaves unexplained, (T, n)."""
        return self.tau - self.model

    @property
    def inner(self) -> slice:
        rows = round(ENDS / self.period)
        return slice(rows, len(self.q) - rows)

    def every(self, step: float) -> slice:
        """Inner rows about so many seconds apart."""
        return slice(self.inner.start, self.inner.stop, max(1, round(step / self.period)))


class Believed:
    """The user's model: a URDF and known rotors, by Pinocchio."""

    def __init__(self, urdf: Path, joints: tuple[str, ...], rotors: Array | None) -> None:
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.rotors = np.zeros(len(joints)) if rotors is None else rotors
        ids = [self.model.getJointId(name) for name in joints]
        self._v = np.array([self.model.idx_vs[i] for i in ids])

    def torque(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Inverse dynamics (T, n)."""
        inverse = np.argsort(self._v)  # all joints of the URDF are the study's
        rows = zip(q[:, inverse], dq[:, inverse], ddq[:, inverse], strict=True)
        tau = np.array([pin.rnea(self.model, self.data, a, b, c) for a, b, c in rows])
        return tau[:, self._v] + self.rotors * ddq

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Torque per inertial parameter, (T, n, 10 n)."""
        inverse = np.argsort(self._v)
        rows = zip(q[:, inverse], dq[:, inverse], ddq[:, inverse], strict=True)
        each = [
            pin.computeJointTorqueRegressor(self.model, self.data, a, b, c).reshape(
                self.model.nv, -1
            )[self._v]
            for a, b, c in rows
        ]
        return np.array(each)


def smooth(values: Array, period: float) -> Array:
    """Low-pass along axis 0 without delay (Butterworth of order 4 forwards and backwards)."""
    sections = signal.butter(4, CUTOFF, fs=1.0 / period, output="sos")
    pad = min(len(values) - 1, round(1.0 / period))
    return np.ascontiguousarray(signal.sosfiltfilt(sections, values, axis=0, padlen=pad))


def track_of(
    recording: Recording, believed: Believed, urdf: Path, unloaded: Believed | None = None
) -> Track:
    """A recording as the methods see it."""
    period = recording.period
    q = smooth(recording.q, period)
    dq = np.gradient(q, period, axis=0)
    ddq = np.gradient(dq, period, axis=0)
    model = believed.torque(q, dq, ddq)
    load = np.zeros_like(q) if unloaded is None else model - unloaded.torque(q, dq, ddq)
    tau = smooth(recording.tau, period)
    return Track(
        recording=recording,
        period=period,
        q=q,
        dq=dq,
        ddq=ddq,
        tau=tau,
        model=model,
        load=load,
        urdf=urdf,
    )


def study_tracks(study: Study) -> tuple[list[Track], list[Track]]:
    """Those to fit, and those that may choose between fits but not enter one."""
    believed = Believed(study.robot, study.joints, study.rotor_inertia)
    return tuple(
        [track_of(recording, believed, study.robot) for recording in some]
        for some in (study.fit, study.validate)
    )


def beyond_track(study: Study, folder: Path, name: str) -> Track:
    """A recording at other conditions; the load's URDF is given where there is a load."""
    plain = Believed(study.robot, study.joints, study.rotor_inertia)
    recording = replace(read_motion(folder / f"{name}.csv", study.joints), name=name)
    if name != "load":
        return track_of(recording, plain, study.robot)
    urdf = folder / "robot_loaded.urdf"
    loaded = Believed(urdf, study.joints, study.rotor_inertia)
    return track_of(recording, loaded, urdf, plain)


def joint_columns(dq: Array, ddq: Array) -> Array:
    """Rotor, viscous and Coulomb friction, and an offset of every joint, (T, n, 4 n)."""
    count, n = dq.shape
    columns = np.zeros((count, n, 4 * n))
    for j in range(n):
        columns[:, j, 4 * j] = ddq[:, j]
        columns[:, j, 4 * j + 1] = dq[:, j]
        columns[:, j, 4 * j + 2] = np.tanh(dq[:, j] / REST)
        columns[:, j, 4 * j + 3] = 1.0
    return columns


def stacked(tracks: list[Track], name: str, step: float) -> Array:
    """One array of all tracks one after the other, about `step` seconds between rows."""
    return np.concatenate([getattr(track, name)[track.every(step)] for track in tracks])
