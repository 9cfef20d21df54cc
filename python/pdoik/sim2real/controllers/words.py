"""Controllers in words: what was found of them, and what they hide."""

from __future__ import annotations

from dataclasses import replace

from ..findings import ControllerEstimate, Estimate
from ..study import Study

_WORTH = 0.8  # share that is worth saying
_NAMES = {
    "pd": "a PD law",
    "pid": "a PID law",
    "cascade": "a position loop around a speed loop (P-PI)",
    "table": "a table of the position error",
}
_EFFORTS = {
    "tau_cmd": "the commanded torque",
    "duty": "the duty",
    "tau": "the torque as reported",
    "current": "the current",
}


def law_in_words(estimate: ControllerEstimate) -> str:
    """One sentence of a law that is believed, or why none is; "" where no effort was logged."""
    where, effort = estimate.joint, _EFFORTS.get(estimate.effort, "")
    if not estimate.effort:
        return ""
    if not estimate.law:
        said = (
            f"{where}: no law of the controller explains {effort}"
            f" (held out, {100 * max(estimate.explained, 0.0):.3g} % of it at best)"
        )
        if estimate.in_band > max(estimate.explained, _WORTH):
            said += (
                f", though in the band of the motion one does ({100 * estimate.in_band:.4g} % of"
                " it): what is logged is too coarse for its gains"
            )
        return f"{said}."
    shown = [name for name in estimate.gains if not _is_none(estimate.gains[name])]
    figures = ", ".join(f"{name} {_figure(estimate.gains[name])}" for name in shown)
    return (
        f"{where}: {effort} follows {_NAMES[estimate.law]}: {figures}; on held-out data it"
        f" explains {100 * estimate.explained:.4g} % of it"
        f" and leaves {estimate.error:.2g}{_unit(estimate.unit)}."
    )


def contradictions(estimate: ControllerEstimate) -> list[str]:
    """Given gains that the effort contradicts."""
    said = []
    for name, given in estimate.given_wrong.items():
        found = estimate.gains[name]
        by = f" ({100 * (given / found.value - 1.0):+.0f} %)" if found.value > 0.0 else ""
        said.append(
            f"{estimate.joint}: the study says {name} = {given:.4g}, its"
            f" {_EFFORTS[estimate.effort].removeprefix('the ')} shows {_figure(found)}: the study's"
            f" value is wrong{by}, and the estimate was used."
        )
    return said


def of_load(estimate: ControllerEstimate) -> list[str]:
    """What a drive whose figures are given says of the model's load; nothing where it agrees."""
    said = []
    for name in ("mass", "length"):
        factor = estimate.load.get(f"{name}_factor")
        if factor is not None and not factor.interval95[0] <= 1.0 <= factor.interval95[1]:
            said.append(
                f"{estimate.joint}: the load's {name} is {_figure(factor)} times the model's, by"
                " the drive's parameters in the study."
            )
    return said


def drive_in_words(estimate: ControllerEstimate, given: bool) -> str:
    """A motor that is driven by a voltage; "" where none was estimated."""
    if not estimate.drive:
        return ""
    figures = ", ".join(
        f"{name.replace('_', ' ')} {_figure(each)}" for name, each in estimate.drive.items()
    )
    scale = (
        "the torque per volt is the study's, so masses can be estimated"
        if given
        else "they were fitted to the model's own masses: of a model twice as heavy all torques"
        " would be twice as large, so a wrong mass looks like another torque per volt"
    )
    return f"{estimate.joint}: torques are duties times a motor's parameters ({figures}); {scale}."


def with_untellable(
    estimate: ControllerEstimate, study: Study, released: bool
) -> ControllerEstimate:
    """The estimate with what the law and the channels hide, in words."""
    said: list[str] = []
    gains = estimate.gains
    if not estimate.law:
        return estimate
    if "ki" in gains:
        said.append(
            "its integral takes up whatever is constant: a load, an offset or friction at rest"
            " shows in the effort and in no position error"
        )
    if estimate.effort in ("tau_cmd", "duty"):
        said.append(
            "the effort is a command: a gain of the drive looks like masses that are all wrong by"
            " the same factor"
        )
    if "gravity" in gains or "inertia" in gains:
        said.append(
            "the factor of its feed-forward is of its own model: it says nothing about the"
            " machine's masses"
        )
    if "limit" in gains:
        said.append("while its output is at its limit, its gains have no effect")
    if estimate.effort == "duty" and not _given_scale(study):
        rotor = study.rotor_inertia is None
        said.append(
            "only ratios of load and drive are seen: the load's mass and the torque per volt"
            + (", its length and the rotor's inertia" if rotor else "")
            + " cannot be separated"
        )
        if not released:
            said.append("a back-EMF and viscous friction look the same while the drive stays on")
    if estimate.law == "pid":
        said.append(
            "a position loop around a speed loop that gets the desired speed is the same law"
        )
    if estimate.law == "pd" and study.told is not None and study.told.type == "cascade":
        said.append("a position loop around a speed loop without an integral is the same PD law")
    return replace(estimate, untellable=tuple(said))


def _given_scale(study: Study) -> bool:
    return study.told is not None and study.told.torque_per_volt is not None


def nothing_known(study: Study, joints: list[str]) -> str:
    """What can be found where neither gains nor effort are known; said before all else."""
    commanded = all(r.q_des is not None for r in study.recordings)
    where = ", ".join(joints)
    if not commanded:
        return (
            f"{where}: neither commands, effort nor gains are known. Only channels can be judged"
            " against one another."
        )
    return (
        f"{where}: neither effort nor the controller's gains are known. What can be found: how late"
        " and how slowly positions follow their commands, by how much they droop under load, the"
        " width at reversals in which they do not follow (play or stiction, one value for both),"
        " offsets. What cannot: torques, friction, masses and inertias, gains of the drive, and"
        " whether play or stiction makes the width. A duty, a current or a torque in the log, or"
        " the controller's gains in the study, would show more."
    )


def _is_none(estimate: Estimate) -> bool:
    low, high = estimate.interval95
    return low <= 0.0 <= high


def _figure(estimate: Estimate) -> str:
    half = 0.5 * (estimate.interval95[1] - estimate.interval95[0])
    return f"{estimate.value:.4g} ± {half:.2g}{_unit(estimate.unit)}"


def _unit(unit: str) -> str:
    if unit in ("1", "-", ""):
        return ""
    return f" {unit}"
