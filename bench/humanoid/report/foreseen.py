"""What the report says of foreseen throws."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from bench.common.markdown import markdown_table
from bench.humanoid.trials.experiment import Job
from bench.humanoid.trials.predict import Budget
from bench.humanoid.trials.store import Record
from bench.humanoid.world.simulate import STANDS


def predict_part(records: dict[Job, Record], budget: Budget) -> list[str]:
    """Headings, words and tables."""
    return [
        "## Foreseen throws\n",
        f"Each throw hits a robot that stands still. Postures are looked for during"
        f" {budget.seconds:g} s, before the throw; the best plan is then followed at 1 kHz, until"
        f" {budget.after:g} s behind the throw. *Dodged*: untouched, and at the end the CoM is in"
        f" the box of Eq. com, within {1e3 * STANDS:g} mm. *Dodgeable*: dodged, or one of the plans"
        f" of a longer search dodges: {budget.long_seconds:g} s over {budget.long_seeds} other"
        f" seeds, the best {budget.long_plans} plans of each and those left of the short search"
        " tried in simulation until one does.\n",
        _predict_summary(records),
        _not_dodged(records),
        _free_against_welded(records),
        *(
            f"### Every throw, {name}\n\n{_predict_table(of_setup(records, name))}"
            for name in setups(records)
        ),
        "### Feet, centre of mass, motors\n",
        _motion_table(records),
        "### The answers, judged by themselves and by others\n",
        "Worst over all runs. *Judged*: the right foot and the CoM by Pinocchio on the URDF (MuJoCo"
        " where it is missing), distances by MuJoCo's own shapes at the answered postures. Feet on"
        " the floor ask for a CoM over the soles instead of the box's y.\n",
        _answers_table(records),
    ]


def dodged(record: Record) -> bool:
    """Whether the best plan of the short search dodges."""
    return bool(record.get("run", {}).get("dodged"))


def _predict_summary(records: dict[Job, Record]) -> str:
    head = ["set-up", "throws", "hit if it stands still", "dodged", "dodgeable", "dodged of these",
            "touched", "untouched, fell", "no plan"]  # fmt: skip
    rows = []
    for name in setups(records):
        some = list(of_setup(records, name).values())
        able = sum(map(dodgeable, some))
        runs = [record["run"] for record in some if "run" in record]
        rows.append(
            [
                name,
                str(len(some)),
                str(sum(record["standing_still"] is not None for record in some)),
                str(sum(map(dodged, some))),
                str(able),
                f"{100 * sum(map(dodged, some)) / able:.0f} %" if able else "-",
                str(sum(not run["untouched"] for run in runs)),
                str(sum(run["untouched"] and not run["stands"] for run in runs)),
                str(sum("run" not in record for record in some)),
            ]
        )
    return markdown_table(head, rows)


def dodgeable(record: Record) -> bool:
    """Whether any plan dodges."""
    return dodged(record) or bool(record.get("long", {}).get("dodged"))


def cause(record: Record) -> str:
    """Why the short search did not dodge, in words."""
    search = record["search"]
    if "run" not in record:
        if search["found"] == 0:
            return f"no posture clear of the swept cloud among {search['tried']} guesses"
        return f"{search['found']} postures found, none of them reached in time clear of the object"
    run, checks = record["run"], record["checks"]
    words = []
    if run["contact"]:
        words.append(f"touched {run['contact']['link']} at {run['contact']['time']:.2f} s")
        clear = checks["least_distance"]
        words.append(
            f"the answers were {mm(clear)} mm clear, the robot lagged by"
            f" {run['lag']:.2f} rad ({run['lag_joint']})"
            if clear > 0
            else f"the answers themselves touch, by {mm(-clear)} mm"
        )
    elif not run["stands"]:
        words.append(f"untouched, fell over by {run['duration']:.2f} s")
    if run["first_saturated"]:
        first = run["first_saturated"]
        words.append(f"first at its torque limit: {first['joint']} at {first['time']:.2f} s")
    if run["first_lifted"] is not None and record["setup"] in ("free", "balanced"):
        words.append(f"a sole lifts at {run['first_lifted']:.2f} s")
    excess = record["plan"].get("excess")
    if excess:
        words.append(f"the plan asked {excess:.0f} N m more of the ankles than allowed")
    return "; ".join(words)


def _long_words(record: Record) -> str:
    long = record.get("long")
    if long is None:
        return ""
    n = sum(search["tried"] for search in long["searches"])
    plans = sum(search["plans"] for search in long["searches"])
    end = f"plan {long['simulated']} of them dodges" if long["dodged"] else "none dodges"
    return f" Longer search: {n} guesses, {plans} plans, {long['simulated']} simulated, {end}."


def _not_dodged(records: dict[Job, Record]) -> str:
    lines = [
        f"- {job.setup.name} {job.index}, {record['throw']['object_name']} at"
        f" {record['throw']['speed']:.2f} m/s ({_state(record)}): {cause(record)}."
        f"{_long_words(record)}"
        for job, record in records.items()
        if not dodged(record)
    ]
    return "\n".join(["Not dodged:\n", *lines]) + "\n" if lines else "All were dodged.\n"


def _state(record: Record) -> str:
    return "dodgeable" if dodgeable(record) else "not dodgeable"


def _free_against_welded(records: dict[Job, Record]) -> str:
    by = {(job.setup.name, job.index): record for job, record in records.items()}
    lines = [_against_welded(by, name) for name in ("free", "balanced")]
    return "\n".join(line for line in lines if line)


def _against_welded(by: dict[tuple[str, int], Record], setup: str) -> str:
    both = sorted(k for name, k in by if name == setup and ("welded", k) in by)
    if not both:
        return ""
    welded = [k for k in both if dodged(by["welded", k])]
    stands = [k for k in welded if dodged(by[setup, k])]
    lost = [str(k) for k in welded if k not in stands]
    more = [str(k) for k in both if k not in welded and dodged(by[setup, k])]
    text = (
        f"Of the {len(welded)} throws dodged with welded feet, {len(stands)} are dodged {setup},"
        " planned anew with the CoM over the soles"
    )
    text += f"; not {', '.join(lost)}" if lost else ""
    text += f"; {setup} but not welded: {', '.join(more)}" if more else ""
    return text + ".\n"


def _predict_table(records: dict[Job, Record]) -> str:
    head = ["throw", "object", "would touch", "outcome", "speed [m/s]", "contact due [s]",
            "guesses", "postures", "plans", "planning [s]", "least distance [mm]",
            "solver [Hz] min", "median", "max"]  # fmt: skip
    rows = []
    for job, record in records.items():
        run, still = record.get("run"), record["standing_still"]
        rate = record.get("answers", {}).get("rate")
        rows.append(
            [
                str(job.index),
                record["throw"]["object_name"][4:],
                still["link"].removesuffix("_link") if still else "nothing",
                _outcome(run),
                f"{record['throw']['speed']:.2f}",
                f"{still['time']:.2f}" if still else "-",
                *(str(record["search"][key]) for key in ("tried", "found", "plans")),
                f"{record['search']['planning_seconds']:.1f}",
                mm(run["least_distance"]) if run else "-",
                *([f"{value:.0f}" for value in rate] if rate else ["-"] * 3),
            ]
        )
    return markdown_table(head, rows)


def _outcome(run: Record | None) -> str:
    if run is None:
        return "no plan"
    if not run["untouched"]:
        return f"touched {run['contact']['link'].removesuffix('_link')}"
    return "dodged" if run["stands"] else "fell"


def _motion_table(records: dict[Job, Record]) -> str:
    head = ["set-up", "runs", "CoM out of its box x", "y", "z [mm]", "at the end [mm]",
            "foot drift [mm]", "lag [rad]", "joint",
            "torque at its limit, of the time"]  # fmt: skip
    rows = []
    for name in setups(records):
        for label, keep in (("dodged", True), ("not", False)):
            runs = [
                record["run"]
                for record in of_setup(records, name).values()
                if "run" in record and dodged(record) is keep
            ]
            if not runs:
                continue
            lag = max(runs, key=lambda run: float(run["lag"]))
            rows.append(
                [
                    f"{name}, {label}",
                    str(len(runs)),
                    *(mm(max(run["com_beyond_box"][k] for run in runs), 1) for k in range(3)),
                    mm(max(max(run["com_beyond_box_at_end"]) for run in runs), 1),
                    mm(max(run["foot_drift"] for run in runs), 3),
                    f"{lag['lag']:.2f}",
                    lag["lag_joint"].removesuffix("_joint"),
                    _saturation(runs),
                ]
            )
    return markdown_table(head, rows)


def _saturation(runs: list[Record]) -> str:
    """Joints whose torque is at its limit for 1 % of a run or more; the worst run's share."""
    worst: dict[str, float] = {}
    for run in runs:
        for joint, share in run["saturation"].items():
            worst[joint] = max(share, worst.get(joint, 0.0))
    shown = sorted((item for item in worst.items() if item[1] >= 0.01), key=lambda item: -item[1])
    return ", ".join(f"{name.removesuffix('_joint')} {100 * s:.0f} %" for name, s in shown) or "-"


def _answers_table(records: dict[Job, Record]) -> str:
    names = setups(records)
    some = {
        name: [record for record in of_setup(records, name).values() if "run" in record]
        for name in names
    }
    some = {name: found for name, found in some.items() if found}

    def row(
        label: str, part: str, key: str, pick: Callable[..., Any], scale: float, form: str
    ) -> list[str]:
        cells = [label]
        for found in some.values():
            values = [record[part][key] for record in found]
            values = [max(v) if isinstance(v, list) else v for v in values if v is not None]
            cells.append(format(scale * pick(values), form) if values else "-")
        return cells

    rows = [
        row("right foot's position, own [mm]", "answers", "position_error", max, 1e3, ".4f"),
        row("... judged [mm]", "checks", "position_error", max, 1e3, ".4f"),
        row("right foot's rotation, own [mrad]", "answers", "rotation_error", max, 1e3, ".4f"),
        row("... judged [mrad]", "checks", "rotation_error", max, 1e3, ".4f"),
        row("CoM out of its region, own [mm]", "answers", "balance_violation", max, 1e3, ".3f"),
        row("... out of the box, judged [mm]", "checks", "com_beyond_box", max, 1e3, ".3f"),
        row("hulls to the object, own [mm]", "answers", "clearance", min, 1e3, ".1f"),
        row("... shapes, judged [mm]", "checks", "least_distance", min, 1e3, ".1f"),
        row("capsules to one another, own [mm]", "answers", "self_distance", min, 1e3, ".1f"),
        row("... shapes, judged [mm]", "checks", "self_distance", min, 1e3, ".1f"),
        row("step over its limit", "answers", "largest_jump", max, 1, ".6f"),
    ]
    statuses = ["steps' statuses"]
    for found in some.values():
        total: Counter[str] = Counter()
        for record in found:
            total.update(record["answers"]["statuses"])
        statuses.append(", ".join(f"{name} {n}" for name, n in total.most_common()))
    return markdown_table(["", *some], [*rows, statuses])


def mm(metres: float | None, digits: int = 0) -> str:
    """A length in millimetres."""
    return "-" if metres is None else f"{1e3 * metres:.{digits}f}"


def of_setup(records: dict[Job, Record], setup: str) -> dict[Job, Record]:
    """The trials of one set-up."""
    return {job: record for job, record in records.items() if job.setup.name == setup}


def setups(records: dict[Job, Record]) -> list[str]:
    """Those that the trials are of, in order."""
    return list(dict.fromkeys(job.setup.name for job in records))
