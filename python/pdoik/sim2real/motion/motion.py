"""A recording's motion, and what the model says of it, at the rate the diagnosis works at."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from pdoik.recordings import FloatArray, Recording

from ..study import Controller, FloatingBase, Setup
from ..thresholds import Thresholds
from .base_motion import BaseMotion, CarriedBody, base_motion_of
from .feet import FootMotion, feet_of
from .place import Columns, Key, foot_of, tilt_key
from .rigid_body import RigidBody
from .signals import derivative, dilated, shifted, zero_phase

Source = Literal["tau", "current", "duty", "tau_cmd", "law", ""]

_WORKING_RATE = 200.0  # recordings faster than twice this are thinned to at least this [Hz]
_WIDER = 2.5  # the motion is filtered this much wider than the balances are
_LARGE = ("regressor", "joint_poses", "placement ", "play ")  # names of what is kept for a while


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """A smooth motion and its model; arrays are (T, n) or, as in `RigidBody`, (T, rows, ...)."""

    recording: Recording
    body: RigidBody | None
    period: float
    time: FloatArray  # (T,) from the recording's start [s]
    since: float  # of the first sample since the file's start: blocks of a file follow one another
    clock: float = 0.0  # recorded time of the study before this recording, in its order [s]
    cutoff: float  # of the balances [Hz]
    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    speed_floor: FloatArray  # (n,) below it the sign of the speed is not known [rad/s]
    still: NDArray[np.bool_]
    valid: NDArray[np.bool_]  # (T,)
    torque: FloatArray | None  # as recorded, commanded or by the controller's law; NaN columns
    source: Source  # of the torque
    command: FloatArray | None  # commanded torque, where both were recorded
    law: FloatArray | None  # torque by the controller's law
    controller: Controller | None
    tau: FloatArray  # (T, rows) of the rigid body; zeros without a model
    dtau_dq: FloatArray  # (T, rows, n)
    dtau_dv: FloatArray  # (T, rows, n)
    mass_matrix: FloatArray  # (T, rows, n)
    dtau_dgravity: FloatArray  # (T, rows, 3)
    tip: str | None  # link whose pose is measured
    measured_dq: FloatArray | None
    q_des: FloatArray | None
    dq_des: FloatArray | None
    tip_error: FloatArray | None  # (T, 6) measured tip less the model's: translation, rotation
    tip_jacobian: FloatArray | None  # (T, 6, n)
    base: BaseMotion | None = None  # None: it is fixed
    feet: tuple[FootMotion, ...] = ()
    believed: RigidBody | None = None  # by the controller, whose gravity it compensates
    setup: Setup = field(default_factory=Setup)
    cache: dict[str, FloatArray] = field(default_factory=dict, repr=False)
    thresholds: Thresholds = field(default_factory=Thresholds, repr=False)

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])

    @property
    def rows(self) -> int:
        """Rows of its torques: the joints', and the base's where that floats."""
        return int(self.tau.shape[1])

    def row_key(self, i: int) -> Key:
        """The balance that row i of the torques belongs to."""
        return ("torque", i) if i < self.n else ("base", i - self.n)

    @property
    def borne(self) -> FloatArray:
        """What the joints bear by the model, of the likeliest forces on feet too, (T, n)."""
        own = self.tau[:, : self.n]
        by_feet = self.cache.get("tau by feet")
        return own if by_feet is None else own + by_feet[:, : self.n]

    def load(self, j: int) -> FloatArray:
        """Torque through joint j's gear by the model: all but that of its known rotor, (T,)."""
        return np.asarray(self.borne[:, j] - self.rotor(j), dtype=np.float64)

    def dtau_dturn(self) -> FloatArray:
        """Torques per angular acceleration of a floating base, (T, rows, 3)."""
        if "dtau_dturn" not in self.cache:
            assert isinstance(self.body, CarriedBody)
            self.cache["dtau_dturn"] = self.body.base_inertia(self.q)[:, :, 3:]
        return self.cache["dtau_dturn"]

    def judged(self, key: Key) -> NDArray[np.bool_]:
        """Samples at which a foot shows where the ground is, (T,)."""
        return self.feet[foot_of(key)].judged(key)

    def on_rows(self, values: FloatArray) -> Columns:
        """Columns of changes of all torques, (T, rows) of one coefficient or (T, rows, k)."""
        wide = values if values.ndim == 3 else values[:, :, None]
        return {self.row_key(i): wide[:, i] for i in range(wide.shape[1])}

    def soles_by_joint(self, j: int) -> Columns:
        """Apparent heights and tilts of soles per radian that joint j is beyond q, (T, 1)."""
        if self.base is None or self.base.rotation is None:
            return {}
        up = self.base.rotation[:, 2]
        columns: Columns = {}
        for k, foot in enumerate(self.feet):
            if foot.height is not None:
                columns["foot", k] = -np.sum(up * foot.jacobian[:, :, j], axis=1)[:, None]
            if foot.tilt is not None and foot.upright is not None:
                turned = np.cross(foot.turning[:, :, j], foot.upright)
                turned = np.einsum("tij,tj->ti", self.base.rotation, turned)
                height = np.sum(up * foot.upright, axis=1)
                for axis in range(2):
                    change = turned[:, axis] + foot.tilt[:, axis] * turned[:, 2]
                    columns[tilt_key(k, axis)] = (change / height)[:, None]
        return columns

    def sign(self, j: int, smoothing: float = 0.0) -> FloatArray:
        """Direction of joint j, -1 to 1, smooth within `smoothing` [rad/s] of rest; (T,)."""
        scale = max(smoothing, 0.5 * self.speed_floor[j])
        return np.asarray(np.tanh(self.dq[:, j] / scale), dtype=np.float64)

    def regressor(self) -> FloatArray:
        """Torque per inertial parameter, (T, rows, links, 10)."""
        if "regressor" not in self.cache:
            assert self.body is not None
            gravity = self.cache.get("gravity")
            self.cache["regressor"] = self.body.regressor(self.q, self.dq, self.ddq, gravity)
        return self.cache["regressor"]

    def forget(self) -> None:
        """Leave what is large, whole and quickly made again: only columns of it are used."""
        for name in [name for name in self.cache if name.startswith(_LARGE)]:
            del self.cache[name]

    def pulled_by(self, gravity: FloatArray) -> Motion:
        """The same, with unknown bodies under this gravity, (3,) in the base's frame [m/s^2]."""
        kept = {name: values for name, values in self.cache.items() if name != "regressor"}
        return replace(self, cache={**kept, "gravity": gravity})

    def rotor(self, j: int) -> FloatArray:
        """Torque of joint j's known rotor inertia, (T,)."""
        inertia = 0.0 if self.body is None else float(self.body.rotor[j])
        return inertia * self.ddq[:, j]

    def has_command(self, j: int) -> bool:
        """Whether joint j's torque was recorded together with the drive's command."""
        return self.command is not None and bool(np.isfinite(self.command[:, j]).all())

    def has_law(self, j: int) -> bool:
        """Whether a torque or a command of joint j was recorded besides the controller's law."""
        return self.law is not None and self.source not in ("law", "")

    def law_of(self, j: int) -> FloatArray:
        """The controller's law for joint j, (T,)."""
        assert self.law is not None
        return np.ascontiguousarray(self.law[:, j])

    def given(self, j: int) -> FloatArray:
        """What the controller gave joint j: the command, else the torque; (T,)."""
        recorded = self.recording.tau_cmd
        given = self.torque if recorded is None else recorded
        assert given is not None
        return np.ascontiguousarray(given[:, j])

    def tau_without_rotor(self) -> FloatArray:
        """Torques of the rigid body alone, (T, rows)."""
        if "rigid" not in self.cache:
            assert self.body is not None
            self.cache["rigid"] = self.body.torque(self.q, self.dq, self.ddq)
        return self.cache["rigid"]

    def tau_at_rest(self) -> FloatArray:
        """Torques that would hold the rigid body where it is, (T, rows)."""
        if "at rest" not in self.cache:
            assert self.body is not None
            rest = np.zeros_like(self.dq)
            self.cache["at rest"] = self.body.torque(self.q, rest, rest)
        return self.cache["at rest"]

    def tip_moved(self, q: FloatArray, body: RigidBody | None = None) -> FloatArray:
        """Change of the tip's pose to other positions (T, n), or another body's; (T, 6)."""
        assert self.body is not None
        other = body or self.body
        here = self.body.poses_and_jacobians(self.q, self.body.frame(self.tip))[0]
        there = other.poses_and_jacobians(q, other.frame(self.tip))[0]
        turn = Rotation.from_matrix(there[:, :3, :3] @ np.transpose(here[:, :3, :3], (0, 2, 1)))
        return np.hstack([there[:, :3, 3] - here[:, :3, 3], turn.as_rotvec()])

    def tip_position(self) -> FloatArray:
        """The tip's position by the model, (T, 3)."""
        return self.cache["tip_position"]

    def link_jacobian(self, link: int, *, at_tip: bool = True) -> FloatArray:
        """Linear Jacobian of a link's origin, or of the tip for the last link; (T, 3, n)."""
        name = f"jacobian {link} {at_tip}"
        if name not in self.cache:
            assert self.body is not None
            tip = at_tip and link == self.body.last
            frame = self.body.frame(self.tip if tip else self.body.links[link])
            self.cache[name] = self.body.poses_and_jacobians(self.q, frame)[1][:, :3].copy()
        return self.cache[name]

    def by_motion(self, j: int, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """Change of the torques, (T, rows), where joint j moves by (T,) more, to first order."""
        change = (
            self.dtau_dq[:, :, j] * q[:, None]
            + self.dtau_dv[:, :, j] * dq[:, None]
            + self.mass_matrix[:, :, j] * ddq[:, None]
        )
        return np.asarray(change, dtype=np.float64)

    def by_deflection(self, deflection: FloatArray, j: int) -> FloatArray:
        """Change of the rigid body's torques where joint j's link lags by `deflection`; (T, n).

        tau(q - d) - tau(q) to first order; `deflection` is (T,) [rad].
        """
        smooth = zero_phase(deflection, self.cutoff, self.period)
        speed = derivative(smooth, self.period)
        acceleration = derivative(speed, self.period)
        return -self.by_motion(j, smooth, speed, acceleration)


def thinned(recording: Recording) -> Recording:
    """The recording at a rate of at least 200 Hz, filtered before samples are left out."""
    every = int(1.0 / (recording.period * _WORKING_RATE))
    if every < 2:
        return recording
    cutoff = 0.4 / (recording.period * every)
    changes: dict[str, FloatArray] = {}
    for name in recording.channels:
        values: FloatArray = getattr(recording, name)
        changes[name] = zero_phase(values, cutoff, recording.period)[::every]
    keep = ~dilated(~recording.valid, every)[::every]
    if recording.released is not None:
        changes["released"] = recording.released[::every]  # type: ignore[assignment]
    return replace(recording, time=recording.time[::every], valid=keep, **changes)  # type: ignore[arg-type]


def control_law(
    recording: Recording, controller: Controller, body: RigidBody | None
) -> FloatArray | None:
    """Torque the controller asks for, (T, n); None where it cannot be known."""
    if recording.q_des is None or (controller.gravity_compensation and body is None):
        return None
    speed = recording.dq
    if speed is None:
        speed = derivative(recording.q, recording.period)
    aim = 0.0 if recording.dq_des is None else recording.dq_des
    error, rate = recording.q_des - recording.q, aim - speed
    drive = controller.drive
    if drive is not None:
        assert controller.kp_duty is not None
        assert controller.kd_duty is not None
        duty = controller.kp_duty * error + controller.kd_duty * rate
        duty = np.clip(duty, -drive.duty_limit, drive.duty_limit)
        given = duty * drive.volts * (1.0 - drive.supply_loss * np.abs(duty))
        asked = drive.torque_per_volt * given - drive.back_emf * speed
    else:
        asked = controller.kp * error + controller.kd * rate
    if controller.gravity_compensation and body is not None:
        factor = 1.0 if controller.gravity_factor is None else controller.gravity_factor
        asked = asked + factor * body.gravity(recording.q)
    if controller.torque_limit is not None:
        asked = np.clip(asked, -controller.torque_limit, controller.torque_limit)
    if controller.period:  # what is held over a period comes half of it late on average
        asked = shifted(asked, 0.5 * controller.period, recording.period)
    if recording.released is not None:
        asked = np.where(recording.released, 0.0, asked)
    return np.asarray(asked, dtype=np.float64)


def motion_of(
    recording: Recording,
    body: RigidBody | None,
    controller: Controller | None,
    cutoff: float,
    position_noise: FloatArray,
    tip: str | None = None,
    since: float = 0.0,
    thresholds: Thresholds | None = None,
    believed: RigidBody | None = None,
    setup: Setup | None = None,
    floating: FloatingBase | None = None,
) -> Motion:
    """Smooth the motion and evaluate the model along it.

    Args:
        recording: thinned.
        body: None without a robot description.
        controller: None where it is not known.
        cutoff: of the balances [Hz].
        position_noise: (n,) density of white noise in q [rad^2/Hz].
        tip: link whose pose the channel `tip` is.
        since: time from the file's start to the recording's first sample [s].
        thresholds: the defaults if none are given.
        believed: whose gravity the controller compensates; `body` if None.
        setup: of the recording; nothing special if None.
        floating: of the study; None where the base is fixed.
    """
    period, count = recording.period, len(recording.time)
    n = recording.q.shape[1]
    limits = Thresholds() if thresholds is None else thresholds
    wide = _WIDER * cutoff
    q = zero_phase(recording.q, wide, period)
    dq = derivative(q, period)
    ddq = derivative(dq, period)
    # White noise of density S in q gives the speed a variance of S (2 pi)^2 f^3 / 3 below f.
    band = min(wide, 0.5 / period)
    speed_noise = np.sqrt(position_noise * (2 * np.pi) ** 2 * band**3 / 3)
    floor = np.maximum(4.0 * speed_noise, limits.noise.still_speed)
    base = None
    if body is not None and floating is not None:
        base = base_motion_of(recording, floating, wide)
        body = CarriedBody.on(body, base)
        believed = None if believed is None else CarriedBody.on(believed, base)
    zeros = np.zeros((count, n))
    empty = np.zeros((count, n, n))
    tau, by_q, by_v, mass = zeros, empty, empty, empty
    by_gravity = np.zeros((count, n, 3))
    tip_error = tip_jacobian = None
    cache: dict[str, FloatArray] = {}
    if body is not None:
        dynamics = body.dynamics(q, dq, ddq)
        tau, by_q, by_v = dynamics.tau, dynamics.dtau_dq, dynamics.dtau_dv
        mass, by_gravity = dynamics.mass_matrix, dynamics.dtau_dgravity
        if recording.tip is not None:
            poses, tip_jacobian = body.poses_and_jacobians(q, body.frame(tip))
            tip_error = _pose_error(recording.tip, poses)
            cache["tip_position"] = np.ascontiguousarray(poses[:, :3, 3])
    believed = body if believed is None else believed
    law = None if controller is None else control_law(recording, controller, believed)
    torque, source = _torque(recording, law, body is not None)
    feet: tuple[FootMotion, ...] = ()
    if isinstance(body, CarriedBody) and floating is not None:
        feet = feet_of(recording, floating, body, q, cutoff)
    command = recording.tau_cmd if source in ("tau", "current", "duty") else None
    return Motion(
        recording=recording,
        body=body,
        period=period,
        time=recording.time,
        since=since,
        cutoff=cutoff,
        q=q,
        dq=dq,
        ddq=ddq,
        speed_floor=floor,
        still=np.abs(dq) < floor,
        valid=~dilated(~recording.valid, int(0.5 / (cutoff * period)) + 1),
        torque=torque,
        source=source,
        command=command,
        law=law,
        controller=controller,
        tau=tau,
        dtau_dq=by_q,
        dtau_dv=by_v,
        mass_matrix=mass,
        dtau_dgravity=by_gravity,
        tip=tip,
        measured_dq=recording.dq,
        q_des=recording.q_des,
        dq_des=recording.dq_des,
        tip_error=tip_error,
        tip_jacobian=tip_jacobian,
        base=base,
        feet=feet,
        believed=believed,
        setup=Setup() if setup is None else setup,
        cache=cache,
        thresholds=limits,
    )


def _torque(
    recording: Recording, law: FloatArray | None, modelled: bool
) -> tuple[FloatArray | None, Source]:
    """The nearest to a torque that there is; duties are none before a model gives them a scale."""
    if recording.tau is not None:
        return recording.tau, "tau"
    if recording.current is not None:
        return recording.current, "current"
    if recording.duty is not None and modelled:
        return recording.duty, "duty"
    if recording.tau_cmd is not None:
        return recording.tau_cmd, "tau_cmd"
    if law is not None:
        return law, "law"
    return None, ""


def _pose_error(measured: FloatArray, poses: FloatArray) -> FloatArray:
    """Translation and rotation vector from the model's tip to the measured one, base axes."""
    wxyz = measured[:, 3:]
    rotation = Rotation.from_quat(wxyz[:, [1, 2, 3, 0]])
    turned = rotation * Rotation.from_matrix(poses[:, :3, :3]).inv()
    return np.hstack([measured[:, :3] - poses[:, :3, 3], turned.as_rotvec()])
