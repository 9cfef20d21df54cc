"""MuJoCo's system identification toolbox with every number set free that it can vary."""

import contextlib
import io
import logging
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from bench.sim2real.frame.tracks import Array, Track
from bench.sim2real.proof.peers_methods import Predictor, error_of
from pdoik.sim2real import Study

STEP = 0.05  # between rows that enter the fit [s]
LATEST = 0.05  # delay that the fit may find [s]
ROUNDS = 6  # of Gauss and Newton, at most
WORTH = 0.9  # share of the mean square below which gains of the torque sensors are kept
PAUSE = 10.0  # of the clock between two recordings [s]


def sysid(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Damping, frictionloss, armature, ten inertial figures per link; gain, bias, delay of sensors.

    The toolbox's rollout is exchanged for MuJoCo's inverse dynamics along the measured motion (its
    hook `custom_rollout`), so that it fits the very torques it is judged by.
    """
    from mujoco import sysid as toolbox

    logging.getLogger("absl").setLevel(logging.ERROR)
    names = list(study.joints)
    spec = specification(study.robot, study, names)
    model = spec.compile()
    params = parameters(toolbox, spec, model, names)
    q, dq, ddq, tau, times = rows_of(fit)
    order = [int(model.joint(name).dofadr[0]) for name in names]

    def rolled(models: list[Any], param_dicts: list[Any], **given: Any) -> list[Any]:
        return [
            toolbox.SystemTrajectory(
                model=each,
                control=given["control_signal"][0],
                sensordata=toolbox.TimeSeries(
                    times, inverse(each, order, q, dq, ddq), given["rollout_signal_mapping"]
                ),
                initial_state=given["initial_states"][0],
                state=toolbox.TimeSeries(times, np.column_stack([times, q])),
            )
            for each in models
        ]

    def compared(
        now: Any, said: Any, measured: Any, each: Any, everything: bool, **given: Any
    ) -> tuple[Array, Any, Any]:
        said = sensed(toolbox, now, said, names)
        return (said.data - tau) / (spread * np.sqrt(tau.size)), said, said

    spread = np.std(tau - np.concatenate([t.model[t.every(STEP)] for t in fit]), axis=0)
    spread = np.maximum(spread, 1e-9)
    measured = toolbox.TimeSeries.from_names(times, tau, model)
    start = toolbox.create_initial_state(model, np.zeros(model.nq))
    control = toolbox.TimeSeries(times, tau)
    sequences = toolbox.ModelSequences("arm", spec, "fit", start, control, measured)
    residual = toolbox.build_residual_fn(
        models_sequences=[sequences],
        custom_rollout=rolled,
        modify_residual=compared,
        resample_true=False,
        n_threads=1,
    )

    def fitted(params: Any) -> tuple[Any, Predictor]:
        found = optimized(toolbox, params, residual)
        identified = toolbox.apply_param_modifiers(found, spec)

        def predict(track: Track) -> Array:
            tau = inverse(identified, order, track.q, track.dq, track.ddq)
            time = track.period * np.arange(len(tau))
            mapping = toolbox.TimeSeries.compute_all_sensor_mapping(identified)
            said = toolbox.TimeSeries(time, tau + track.load, mapping)
            return sensed(toolbox, found, said, names).data

        return found, predict

    set_gains(params, names, frozen=True)  # with free masses a gain is hard to identify
    plain, predict = fitted(params)
    set_gains(plain, names, frozen=False)
    _, scaled = fitted(plain)
    gain = error_of(scaled, choose, spread) / error_of(predict, choose, spread)
    return scaled if gain < WORTH else predict


def optimized(toolbox: Any, params: Any, residual: Any) -> Any:
    """The parameters found; the optimizer would tell each step."""
    low, high = params.get_bounds()
    with contextlib.redirect_stdout(io.StringIO()):
        found, _ = toolbox.optimize(
            params, residual, verbose=False, max_iters=ROUNDS, x_scale=0.1 * (high - low)
        )
    return found


def set_gains(
    params: Any, names: list[str], of: tuple[str, ...] = ("gain",), *, frozen: bool
) -> None:
    """Fix or free the parameters of the sensors, and those of the drives where they are meant."""
    for name in names:
        for what in of:
            params[f"{name}_{what}"].frozen = frozen


def specification(urdf: Path, study: Study, names: list[str]) -> Any:
    """The URDF in MuJoCo with its rotors, a motor and a torque sensor per joint."""
    spec = mujoco.MjSpec.from_file(str(urdf))
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    for index, name in enumerate(names):
        joint = spec.joint(name)
        if study.rotor_inertia is not None:
            joint.armature = float(study.rotor_inertia[index])
        motor = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=name)
        motor.gainprm[0] = 1.0
        spec.add_sensor(
            name=f"tau_{name}",
            type=mujoco.mjtSensor.mjSENS_JOINTACTFRC,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=name,
        )
    return spec


def parameters(toolbox: Any, spec: Any, model: Any, names: list[str]) -> Any:
    """All that is set free, at the model's own figures."""
    params = toolbox.ParameterDict()
    for name in names:
        dof = model.joint(name)
        effort = float(np.abs(model.jnt_actfrcrange[dof.id]).max()) or 100.0
        armature = float(model.dof_armature[dof.dofadr[0]])
        free = {
            "damping": (1e-3 * effort, 0.0, effort),
            "frictionloss": (1e-3 * effort, 0.0, effort),
            "armature": (armature, 0.0, 5.0 * armature + 0.1),
        }
        for what, (value, low, high) in free.items():

            def change(spec: Any, p: Any, name: str = name, what: str = what) -> None:
                value = float(p.value[0])
                joint = spec.joint(name)
                setattr(joint, what, [value, 0, 0] if what == "damping" else value)

            key = f"{name}_{what}"
            params.add(toolbox.Parameter(key, value, low, high, modifier=change))
        body = model.body(dof.bodyid[0]).name
        params.add(
            toolbox.body_inertia_param(
                spec,
                model,
                body,
                inertia_type=toolbox.InertiaType.Pseudo,
                modifier=lambda spec, p, body=body: inertia_set(toolbox, spec, body, p.value),
            )
        )
        params.add(toolbox.Parameter(f"{name}_gain", 1.0, 0.5, 2.0))
        params.add(toolbox.Parameter(f"{name}_bias", 0.0, -effort, effort))
        params.add(toolbox.Parameter(f"{name}_delay", 0.0, -LATEST, LATEST))
    return params


def inertia_set(toolbox: Any, spec: Any, name: str, theta: Array) -> None:
    """`apply_body_theta_inertia` without compiling the whole arm for every link."""
    pi = toolbox.model_modifier.pi_from_theta(theta)
    set_body(spec.body(name), pi[0], pi[1:4], pi[4:].reshape(3, 3))


def set_body(body: Any, mass: float, moment: Array, about_origin: Array) -> None:
    """Mass, first moment and inertia about the frame's origin (3, 3) of a body."""
    com = moment / mass
    values, axes = np.linalg.eigh(about_origin - carried(mass, com))
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, axes.ravel())
    body.explicitinertial, body.mass, body.ipos = True, mass, com
    body.fullinertia = np.full((6, 1), np.nan)
    body.inertia, body.iquat = values, quaternion


def carried(mass: float, com: Array) -> Array:
    """Inertia about the origin of a mass at its centre (3, 3)."""
    return np.asarray(mass * (com @ com * np.eye(3) - np.outer(com, com)))


def sensed(toolbox: Any, params: Any, said: Any, names: list[str]) -> Any:
    """Torques as the sensors tell them: late, scaled, shifted."""
    for name in names:
        sensor = f"tau_{name}"
        said = toolbox.apply_gain(said, sensor, params[f"{name}_gain"])
        said = toolbox.apply_bias(said, sensor, params[f"{name}_bias"])
    delays = {f"tau_{name}": float(params[f"{name}_delay"].value[0]) for name in names}
    return toolbox.apply_resample_and_delay(said, said.times, 0.0, delays)


def rows_of(tracks: list[Track]) -> tuple[Array, Array, Array, Array, Array]:
    """Motions, torques and times of all tracks one after the other, with pauses between them."""
    arrays = [
        np.concatenate([getattr(track, name)[track.every(STEP)] for track in tracks])
        for name in ("q", "dq", "ddq", "tau")
    ]
    times, begin = [], 0.0
    for track in tracks:
        count = len(track.q[track.every(STEP)])
        times.append(begin + track.period * track.every(STEP).step * np.arange(count))
        begin = times[-1][-1] + PAUSE
    return (*arrays, np.concatenate(times))


def inverse(model: Any, order: list[int], q: Array, dq: Array, ddq: Array) -> Array:
    """MuJoCo's torques (T, n) along a motion."""
    data = mujoco.MjData(model)
    qpos, qvel, qacc, out = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
    back = np.argsort(order)
    q, dq, ddq = q[:, back], dq[:, back], ddq[:, back]
    tau = np.empty_like(q)
    run = mujoco.mj_inverse
    for row in range(len(q)):
        qpos[:], qvel[:], qacc[:] = q[row], dq[row], ddq[row]
        run(model, data)
        tau[row] = out
    return tau[:, order]
