"""A sensor that is noisier than it should be: one joint's positions, speeds or torques."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from pdoik.descriptions import robot_facts
from pdoik.recordings import FloatArray

from ..effects.sensors import SensorNoise
from ..findings import Estimate, Evidence, Finding
from ..motion import Balances, Prepared, shifted
from ..study import Study
from ..thresholds import ChannelThresholds
from .channel_noise import ChannelNoise

_CHANNELS = ("q", "dq", "tau")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Noisy:
    """One joint's channel that stands out."""

    channel: str
    joint: int
    times: float  # as noisy as it should be
    added: float  # share of the noise's power that was never in what the controller read
    heard: bool  # found by what the controller read, else by the other joints' noise


def noisy_channels(prepared: Prepared, study: Study) -> tuple[Finding, ...]:
    """Findings, one for each kind of channel at most.

    Args:
        prepared: the study before channels were mended.
        study: after that.
    """
    limits = study.thresholds.channels
    controller = study.shared_controller
    fit = ChannelNoise(study.fit, controller, _laws(prepared.fit), limits)
    held_out = None
    if prepared.validate is not None:
        held_out = ChannelNoise(study.validate, controller, _laws(prepared.validate), limits)
    found = []
    for channel in _CHANNELS:
        levels = fit.levels(channel)
        if levels is None or levels.shape[1] < 2:
            continue
        std = np.sqrt(np.median(levels, axis=0))
        if channel == "tau":
            std = np.where(_as_recorded(prepared.study, study), std, np.nan)
        noisy = _unheard(limits, fit, channel, std) or _outlier(study, fit, channel, std)
        if noisy is None or (not noisy.heard and _moves(study, fit, channel, noisy.joint)):
            continue
        if fit.white(channel)[noisy.joint] > limits.white:
            halves = levels[: len(levels) // 2 or 1], levels[len(levels) // 2 :]
            weight = min(_beyond_sound(levels, half, noisy) for half in halves)
            again = levels if held_out is None else held_out.levels(channel)
            gain = 0.0 if again is None else _beyond_sound(levels, again, noisy)
            if weight > limits.noise_gain and gain >= 0.0:
                finding = _finding(prepared, study, noisy, levels, gain)
                found.append(replace(finding, weight=weight))
    return tuple(found)


def _unheard(
    limits: ChannelThresholds, noise: ChannelNoise, channel: str, std: FloatArray
) -> _Noisy | None:
    """A joint most of whose noise the controller has not read, other than the others'.

    A sensor's own noise is fed back: kp and kd times it are in the torque. Noise of which nothing
    is there came into the file on another way.
    """
    heard = noise.heard(channel) if channel != "tau" else None
    if heard is None:
        return None
    known = np.isfinite(heard.share) & (std > 0.0)
    worst, best, share = -1, 0.0, 0.0
    scattered, clearly = limits.heard_scatter, limits.unheard_t
    for j in np.flatnonzero(known):
        others = known & (np.arange(len(std)) != j)
        if not others.any():
            continue
        weight = 1.0 / (heard.error[others] ** 2 + (scattered * limits.least_heard) ** 2)
        usual = float(np.average(heard.share[others], weights=weight))
        squares = (heard.share[others] - usual) ** 2 - heard.error[others] ** 2
        scatter = max(float(np.average(squares, weights=weight)), (scattered * usual) ** 2) ** 0.5
        sure = max(clearly * scatter, clearly / np.sqrt(np.sum(weight)))
        if usual < max(limits.least_heard, sure):
            continue
        error = float(np.hypot(heard.error[j], limits.unheard * scatter))
        clear = (limits.unheard * usual - heard.share[j]) / error
        wrong_way = heard.share[j] < -clearly * heard.error[j]
        added = 1.0 - float(np.clip(heard.share[j] / usual, 0.0, 1.0))
        loud = np.sqrt(added) * std[j] > np.min(std[others])
        if clear > clearly and not wrong_way and loud and clear > best:
            worst, best, share = int(j), clear, added
    if worst < 0:
        return None
    times = 1.0 / np.sqrt(max(1.0 - share, 1e-4))
    return _Noisy(channel=channel, joint=worst, times=times, added=share, heard=True)


def _as_recorded(before: Study, after: Study) -> NDArray[np.bool_]:
    """Joints whose torques were not mended: a factor of a channel is one of its noise too."""
    old, new = before.fit[0].tau, after.fit[0].tau
    if old is None or new is None:
        return np.zeros(len(before.joints), dtype=np.bool_)
    return np.asarray(np.all(old == new, axis=0))


def _laws(balances: Balances) -> list[FloatArray | None]:
    """The controller's laws by the positions' derivatives: without noise of the speed's sensor."""
    laws = []
    for m in balances.motions:
        law = m.law
        if law is not None and m.controller is not None and m.measured_dq is not None:
            wrong = m.controller.kd * (m.measured_dq - m.dq)
            law = law + shifted(wrong, 0.5 * (m.controller.period or 0.0), m.period)
        laws.append(law)
    return laws


def _outlier(study: Study, noise: ChannelNoise, channel: str, std: FloatArray) -> _Noisy | None:
    """A joint whose noise is beyond what sound joints differ by, on each scale that is known."""
    known = np.isfinite(std) & (std > 0.0)
    if known.sum() < 2:
        return None
    times = np.inf
    effort = _efforts(study) if channel == "tau" else None
    worst = int(np.argmax(np.where(known, std / (1.0 if effort is None else effort), 0.0)))
    others = known & (np.arange(len(std)) != worst)
    steps = None if channel == "tau" else study.fit[0].steps
    for scale in _scales(noise, channel, effort, steps, std, others):
        ratio = std / scale
        if ratio[worst] < _beyond(study.thresholds.channels, ratio[others], int(known.sum())):
            return None
        times = min(times, float(ratio[worst] / np.median(ratio[others])))
    return _Noisy(channel=channel, joint=worst, times=times, added=1.0, heard=False)


def _moves(study: Study, noise: ChannelNoise, channel: str, j: int) -> bool:
    """Whether a joint's positions or speeds are as much noisier as another of its channels.

    A sensor's own noise moves nothing: what two of them see alike, hums or rings.
    """
    for other in {"q", "dq"} - {channel}:
        levels = noise.levels(other)
        if levels is not None:
            moved = _outlier(study, noise, other, np.sqrt(np.median(levels, axis=0)))
            if moved is not None and moved.joint == j:
                return True
    return False


def _beyond(limits: ChannelThresholds, others: FloatArray, candidates: int) -> float:
    """Noise that no sound joint has, from that of the others: Student's t on a log scale.

    A few joints say little of their spread, so it is shrunk to what is usual.
    """
    logs = np.log(others)
    middle = float(np.mean(logs))
    weight, usual = limits.spread_weight, np.log(limits.usual_spread)
    freedom = weight + len(others) - 1.0
    squares = weight * usual**2 + float(np.sum((logs - middle) ** 2))
    spread = np.sqrt(squares / freedom * (1.0 + 1.0 / len(others)))
    return float(np.exp(middle + stats.t.isf(limits.false_alarm / candidates, freedom) * spread))


def _scales(
    noise: ChannelNoise,
    channel: str,
    effort: FloatArray | None,
    steps: FloatArray | None,
    std: FloatArray,
    others: NDArray[np.bool_],
) -> list[FloatArray]:
    """What noise may be in proportion to: a sensor's range and its reading, (n,) each.

    A drive's torque has noise in proportion to its effort, or, near its limits, to what it
    gives; the share of the latter is at most the least of the other joints. Where no effort is
    known, and for other channels: the noise itself, and what the channel usually comes to. Noise of
    positions and speeds may also be in proportion to encoders' steps: a coarse one is no bad one.
    """
    size = np.maximum(noise.size(channel), 1e-9)
    if effort is None:
        return [np.ones(len(std)), size, *([] if steps is None else [steps])]
    per_size = np.min((std / size)[others])
    per_effort = np.median((std / effort)[others])
    return [np.maximum(effort * per_effort, size * per_size)]


def _efforts(study: Study) -> FloatArray | None:
    """Each joint's limit by the robot's description; None where not all are known."""
    if study.robot is None:
        return None
    facts = robot_facts(study.robot).joints
    limits = [facts[name].effort if name in facts else None for name in study.joints]
    if any(limit is None or not np.isfinite(limit) or limit <= 0.0 for limit in limits):
        return None
    return np.array(limits, dtype=np.float64)


def _beyond_sound(seen: FloatArray, again: FloatArray, noisy: _Noisy) -> float:
    """Share of the noise's power that is more than it should be.

    Args:
        seen: levels (segments, n) by which it was found.
        again: by which it is judged.
        noisy: the joint and how many times too noisy it is.
    """
    before, now = (float(np.median(each[:, noisy.joint])) for each in (seen, again))
    return 1.0 - before / max(noisy.times**2 * now, 1e-300)


def _finding(
    prepared: Prepared, study: Study, noisy: _Noisy, levels: FloatArray, gain: float
) -> Finding:
    j, channel = noisy.joint, noisy.channel
    name, unit = study.joints[j], _unit(study, j, channel)
    value = float(np.sqrt(noisy.added * np.median(levels[:, j])))
    scatter = (
        np.std(np.log(np.maximum(levels[:, j], 1e-300))) / 2.0 * np.sqrt(1.57 * 1.5 / len(levels))
    )
    limits = study.thresholds.channels
    blur = limits.noise_blur * float(np.mean([r.jitter / r.raw_period for r in study.fit]))
    error = value * float(np.hypot(np.hypot(scatter, limits.noise_error), blur))
    said = f"{channel}.{name} has {value:.2g} {unit} of white noise"
    if noisy.heard:
        said += " that is not in what its controller commanded: it came into the recording only."
    else:
        said += f", {noisy.times:.2g} times what the other joints' suggest."
    if channel == "tau":
        period = prepared.fit.motions[0].recording.raw_period
        left = value * float(np.sqrt(min(2.0 * prepared.cutoff * period, 1.0)))
        said += f" Of what acts at this joint, less than about {left:.2g} {unit} cannot be seen."
    return Finding(
        effect=SensorNoise.id,
        joints=(name,),
        recordings=tuple(r.name for r in study.fit),
        regime=f"always, in {channel}.{name}",
        statement=said,
        parameters={"std": Estimate.normal(value, error, unit)},
        decided_by=SensorNoise.decided_by,
        evidence=Evidence.once(gain, channel),
        variant={"q": "position", "dq": "speed", "tau": "torque"}[channel],
    )


def _unit(study: Study, j: int, channel: str) -> str:
    slides = False
    if study.robot is not None:
        facts = robot_facts(study.robot).joints.get(study.joints[j])
        slides = facts is not None and facts.type in ("prismatic", "slide")
    turning, sliding = {"q": ("rad", "m"), "dq": ("rad/s", "m/s"), "tau": ("N m", "N")}[channel]
    return sliding if slides else turning
