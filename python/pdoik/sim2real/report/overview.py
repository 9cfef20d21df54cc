"""One picture that sums up the report: verdict, residuals, the finding's curve, the scores."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.findings import Diagnosis, Finding

from .curves import binned, reach, sample
from .data import ReportData
from .joint_figure import residual_lines, worst_recording
from .study_figures import forest, forest_rows, joint_bars
from .style import AFTER, BEFORE, INK, MUTED, NOISE, png_of, quiet_legend, short
from .words import VERDICTS, effect_name, percent, place


def _axis(finding: Finding) -> str:
    effect = CATALOGUE.get(finding.effect)
    return "dq" if effect is None or effect.against == "speed" else effect.against


def overview_png(diagnosis: Diagnosis, data: ReportData) -> bytes:
    """The picture for a README."""
    order = affected_joints(diagnosis, data)
    figure = Figure(figsize=(12.4, 7.6))
    figure.text(0.018, 0.965, VERDICTS[diagnosis.verdict][0], fontsize=15.5, weight="bold",
                va="center", color=INK)  # fmt: skip
    figure.text(0.018, 0.944, _subtitle(diagnosis, data), fontsize=9.5, va="top", color=MUTED,
                linespacing=1.5)  # fmt: skip
    left, right = 0.062, 0.985
    shown = [
        joint
        for joint in order[:2]
        if _during(data, joint) or _badness(diagnosis, data, joint) < -1.3
    ] or order[:1]
    top = figure.add_gridspec(
        len(shown), 1, left=left, right=0.62, top=0.845, bottom=0.475, hspace=0.35
    )
    for k, joint in enumerate(shown):
        _residual(figure.add_subplot(top[k]), data, joint, k == 0, k == len(shown) - 1)
    names = [data.joints[joint] for joint in order[:8]]
    bars = figure.add_gridspec(1, 1, left=0.725, right=right, top=0.845, bottom=0.475)
    axes = figure.add_subplot(bars[0])
    fits = diagnosis.joints
    joint_bars(axes, {name: fits[name] for name in names if name in fits}, room=1.55)
    axes.set_title("held-out residual by joint")
    found = curve_findings(diagnosis, data)
    curves = figure.add_gridspec(
        1, max(len(found), 1), left=left, right=0.58, top=0.375, bottom=0.075, wspace=0.24
    )
    for k, finding in enumerate(found):
        joint = data.joints.index(finding.joints[0]) if finding.joints else order[0]
        number = diagnosis.findings.index(finding)
        finding_curve(figure.add_subplot(curves[k]), data, joint, finding, number)
    if not found:
        finding_curve(figure.add_subplot(curves[0]), data, order[0], None)
    scores = figure.add_gridspec(1, 1, left=0.75, right=right, top=0.375, bottom=0.075)
    axes = figure.add_subplot(scores[0])
    if data.hypotheses:
        forest(axes, forest_rows(data.hypotheses, 10), width=32)
        axes.set_xlabel("gain on held-out data, given the rest")
        axes.set_title("what was tried")
    else:
        axes.set_axis_off()
        axes.text(0, 0.5, "no hypothesis was tried", color=MUTED, va="center")
    return png_of(figure, 120)


def affected_joints(diagnosis: Diagnosis, data: ReportData) -> list[int]:
    """Numbers of the joints, those with the largest residual relative to their noise first."""

    def key(joint: int) -> tuple[float, float]:
        return -_during(data, joint), _badness(diagnosis, data, joint)

    return sorted(range(len(data.joints)), key=key)


def _during(data: ReportData, joint: int) -> float:
    """Residual during events in units of its noise, where it stands out; 0 without any."""
    floor = data.noise_floor[joint]
    worst = 0.0
    for name, begin, end in data.events:
        for traces in data.recordings:
            if traces.name == name and floor > 0:
                inside = (traces.time >= begin) & (traces.time < end)
                values = traces.before[inside, joint]
                values = values[np.isfinite(values)]
                if values.size:
                    worst = max(worst, float(np.sqrt(np.mean(values**2))) / floor)
    return worst if worst > 2.0 else 0.0


def _badness(diagnosis: Diagnosis, data: ReportData, joint: int) -> float:
    """Less the residual in units of its noise."""
    fit = diagnosis.joints.get(data.joints[joint])
    if fit is None or not fit.excited or not fit.noise_floor > 0:
        return 0.0
    return -float(np.nan_to_num(fit.before / fit.noise_floor))


def curve_findings(diagnosis: Diagnosis, data: ReportData) -> list[Finding]:
    """The first two findings that are seen in a curve of one joint, each in another curve."""
    chosen: dict[tuple[str, str], Finding] = {}
    for number, finding in enumerate(diagnosis.findings):
        joint = finding.joints[0] if finding.joints else ""
        if joint in data.joints and not _has_part(data, number, data.joints.index(joint)):
            continue  # of a channel, or a drive's law: this residual shows nothing of it
        if joint in data.joints or (not joint and _axis(finding) != "dq"):
            chosen.setdefault((joint, _against(finding)), finding)
    return list(chosen.values())[:2]


def _has_part(data: ReportData, number: int, joint: int) -> bool:
    """Whether a finding moves a joint's residual; unknown where parts are not given one by one."""
    parts = [t.parts[number][:, joint] for t in data.held_out if number < len(t.parts)]
    return not parts or any(bool(np.any(np.nan_to_num(part))) for part in parts)


def _against(finding: Finding | None) -> str:
    return _axis(finding) if finding else "dq"


def finding_curve(
    axes: Axes, data: ReportData, joint: int, finding: Finding | None, number: int = 0
) -> None:
    """The residual over what a finding depends on, less the others' part, and its own part.

    `number` is the finding's among those of the diagnosis.
    """
    field = _against(finding)
    some = data.held_out
    alone = all(number < len(traces.parts) for traces in some)
    if finding and alone and not finding.joints:
        _predicted(axes, data, joint, finding, number)
        return
    x, before, after = (
        np.concatenate([getattr(traces, name)[:, joint] for traces in some])
        for name in (field, "before", "after")
    )
    if alone and finding:
        before = after + np.concatenate([traces.parts[number][:, joint] for traces in some])
    chosen = sample(len(x), 5000)
    axes.plot(x[chosen], before[chosen], ".", ms=2.0, mew=0, alpha=0.35, color=BEFORE,
              rasterized=True, label="_")  # fmt: skip
    axes.axhline(0, color=MUTED, lw=0.8)
    bins = binned(x, before, 26)
    axes.fill_between(bins.x, bins.low, bins.high, color=BEFORE, alpha=0.22, lw=0)
    several = finding is not None and alone and len(some[0].parts) > 1
    label = "residual less the others" if several else "residual"
    axes.plot(bins.x, bins.median, "o", ms=4, color=BEFORE, label=f"{label}, median")
    if finding:
        model = binned(x, before - after, 26)
        own = "the finding's part" if alone else "the findings' part"
        axes.plot(model.x, model.median, color=AFTER, lw=2.2, label=own)
    unit = data.position_unit(joint)
    label = {
        "dq": f"speed [{unit}/s]",
        "q": f"position [{unit}]",
        "load": f"load [{data.load_unit(joint)}]",
    }[field]
    axes.set(xlabel=label, ylabel=f"residual [{data.units[joint]}]", ylim=reach(before))
    name = short(data.joints[joint], 20)
    what = f"{name}: {effect_name(finding.effect)}" if finding else name
    axes.set_title(short(what, 44))
    axes.legend(loc="best", fontsize=7.5)


def _predicted(axes: Axes, data: ReportData, joint: int, finding: Finding, number: int) -> None:
    """The residual less the others' part over what a finding of a link or the base predicts."""
    some = data.held_out
    if finding.window:
        some = tuple(t for t in data.recordings if t.name in finding.recordings)
    part, after = (
        np.concatenate(arrays)
        for arrays in zip(
            *((t.parts[number][:, joint], t.after[:, joint]) for t in some), strict=True
        )
    )
    if finding.window:
        after = np.where(np.abs(part) > 0.02 * np.abs(part).max(), after, np.nan)
    chosen = sample(len(part), 4000)
    axes.plot(part[chosen], (after + part)[chosen], ".", ms=2.5, mew=0, alpha=0.5, color=BEFORE,
              rasterized=True, label="residual less the others")  # fmt: skip
    known = part[np.isfinite(after)]
    ends = [float(known.min()), float(known.max())] if known.size else [0.0, 0.0]
    axes.plot(ends, ends, color=AFTER, lw=1.6, label="the finding")
    unit = data.units[joint]
    axes.set(xlabel=f"predicted by the finding [{unit}]", ylabel=f"residual [{unit}]")
    axes.set_title(short(f"{short(data.joints[joint], 20)}: {effect_name(finding.effect)}", 44))
    axes.legend(loc="best", fontsize=7.5, markerscale=3)


def _residual(axes: Axes, data: ReportData, joint: int, first: bool, last: bool) -> None:
    traces = worst_recording(data, joint)
    residual_lines(axes, traces.time, traces.before[:, joint], traces.after[:, joint])
    floor = data.noise_floor[joint]
    if np.isfinite(floor):
        axes.axhspan(-2 * floor, 2 * floor, color=NOISE, alpha=0.3, lw=0, zorder=0)
    for name, begin, end in data.events:
        if name == traces.name:
            axes.axvspan(begin, end, color=MUTED, alpha=0.15, lw=0, zorder=0)
    axes.plot([], [], color=BEFORE, label="before")
    axes.plot([], [], color=AFTER, label="after")
    axes.fill_between([], [], [], color=NOISE, alpha=0.3, lw=0, label="noise, ±2 std")
    limit = reach(traces.before[:, joint], np.array([-2 * floor, 2 * floor]))
    axes.set(
        xlim=(float(traces.time[0]), float(traces.time[-1])), ylim=limit,
        ylabel=f"residual [{data.units[joint]}]",
        title=short(f"{short(data.joints[joint], 20)}, {traces.name}", 44),
    )  # fmt: skip
    if first:
        quiet_legend(axes)
    if last:
        axes.set_xlabel("time [s]")
    else:
        axes.tick_params(labelbottom=False)


def _subtitle(diagnosis: Diagnosis, data: ReportData) -> str:
    parts = [
        f"{effect_name(each.effect)} at {place(each)} ({percent(each.evidence.validation_gain)})"
        for each in diagnosis.findings[:3]
    ]
    found = "; ".join(parts) or "no finding"
    more = len(diagnosis.findings) - 3
    first = f"{data.title}: {found}{f'; and {more} more' if more > 0 else ''}."
    shares = (
        "Shares are of the mean square residual of the joints each acts on, on recordings nothing"
        " was fitted to."
    )
    return f"{short(first, 150)}\n{shares}" if diagnosis.findings else short(first, 150)
