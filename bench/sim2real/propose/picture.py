"""The picture of `pdoik propose` in the README: two frictions along a log and a proposed motion.

    python -m bench.sim2real.propose.picture bench/sim2real/propose/propose.png

An arm with dry friction in its second joint, moved slowly once, is diagnosed, and presliding is
added to that finding by hand, as if it were listed: the motion that is proposed for it is drawn
next to the log, with the friction of either name along both.
"""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import matplotlib.pyplot as plt
import numpy as np
import typer

from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.propose.worlds import poor_world
from pdoik._files import renamed_when_whole
from pdoik.sim2real import Diagnosis, Equivalent, examine, load_study, model_of, preprocess
from pdoik.sim2real.effects.friction import bristle
from pdoik.sim2real.propose import Proposal, Wishes, propose
from pdoik.sim2real.report import house_style

SPEC = WorldSpec(seed=8000, effect="coulomb_friction", robot="random3")
JOINT = "joint2"
WIDTHS = np.geomspace(1.2e-3, 0.1, 30)  # over which bristles may bend [rad]
STILL = 2e-3  # [rad/s]
PERIOD = 0.01
SHOWN = 4.0  # of either motion [s]

Array = np.ndarray


def main(out: Annotated[Path, typer.Argument(help="PNG.")]) -> None:
    """Diagnose, propose, draw."""
    with tempfile.TemporaryDirectory(prefix="pdoik-propose-") as folder:
        study = poor_world(SPEC, "slow").write(Path(folder) / "study")
        examination = examine(study)
        report = Path(folder) / "report"
        report.mkdir()
        diagnosis = doubted(examination.diagnosis)
        (report / "diagnosis.json").write_text(diagnosis.to_json())
        model_of(examination).save(report)
        proposal = propose(report, Wishes(effort=60, search=np.inf))
        recording = preprocess(load_study(study)).prepared.fit.motions[0]
        at = proposal.joints.index(JOINT)
        logged = np.arange(0.0, recording.time[-1], PERIOD)
        log = np.interp(logged, recording.time, recording.q[:, at])
    with house_style(), renamed_when_whole(out) as path:
        figure = picture(diagnosis, proposal, (logged, log))
        figure.savefig(path, dpi=110, bbox_inches="tight")


def doubted(diagnosis: Diagnosis) -> Diagnosis:
    other = (Equivalent(effect="presliding_hysteresis", joints=(JOINT,)),)
    findings = (
        replace(each, equivalents=other) if JOINT in each.joints else each
        for each in diagnosis.findings
    )
    return replace(diagnosis, findings=tuple(findings))


def picture(diagnosis: Diagnosis, proposal: Proposal, log: tuple[Array, Array]) -> plt.Figure:
    """Positions above, friction by either name below."""
    level = next(f for f in diagnosis.findings if JOINT in f.joints).values["level"]
    time = np.arange(0.0, proposal.time[-1], PERIOD)
    q = proposal.at(time)
    at = proposal.joints.index(JOINT)
    figure, axes = plt.subplots(2, 2, figsize=(9.6, 5.2), layout="constrained")
    (above, right), (below, last) = axes
    above.plot(*log, color="#1f5fa8")
    above.set(title="as it was logged", ylabel=f"{JOINT} [rad]", xlabel="time [s]")
    for k, name in enumerate(proposal.joints):
        bold = k == at
        right.plot(time, q[:, k], color="#1f5fa8" if bold else "0.75", label=name, zorder=2 + bold)
    right.set(title="the motion that is proposed", xlabel="time [s]")
    right.legend(loc="upper right", fontsize=8)
    for axis, (t, x) in ((below, log), (last, (time, q[:, at]))):
        truth, other, moving = level * direction(x), level * bristles(x), moves(x)
        left = float(np.sum((truth - other)[moving] ** 2) / np.sum(truth[moving] ** 2))
        first = busiest(t, x)
        shown = (t >= first) & (t <= first + SHOWN)
        blank = np.where(moving, 1.0, np.nan)
        axis.plot(t[shown], (truth * blank)[shown], color="#c0392b", label="Coulomb friction")
        axis.plot(
            t[shown], (other * blank)[shown], "--", color="#2a9d5c", label="presliding, fitted"
        )
        axis.set(xlabel="time [s]", title=f"differ by {100 * left:.2g} % of the power")
    below.set_ylabel("friction [N m]")
    below.legend(loc="lower right", fontsize=8)
    (expected,) = [each for each in proposal.prospects if JOINT in each.finding]
    figure.suptitle(
        f"{expected.finding}, or presliding: confidence {expected.confidence_before:.2f},"
        f" expected {expected.confidence:.2f} after one motion of {proposal.time[-1]:.0f} s",
        fontsize=11,
    )
    return figure


def direction(x: Array) -> Array:
    return np.tanh(np.gradient(x, PERIOD) / (0.5 * STILL))


def moves(x: Array) -> Array:
    """Rows that count: at rest dry friction takes any value."""
    return np.abs(np.gradient(x, PERIOD)) > STILL


def bristles(x: Array) -> Array:
    """The presliding friction that fits the direction best, of any level and width."""
    truth, moving = direction(x), moves(x)
    best = None
    for width in WIDTHS:
        column = bristle(x, float(width))
        level = float(column[moving] @ truth[moving] / (column[moving] @ column[moving]))
        left = float(np.sum((truth - level * column)[moving] ** 2))
        if best is None or left < best[0]:
            best = left, level * column
    assert best is not None
    return best[1]


def busiest(t: Array, x: Array) -> float:
    """Begin of the stretch with most reversals [s]."""
    turns = np.abs(np.diff(np.sign(np.gradient(x, PERIOD)), prepend=0.0)) > 1.0
    counts = np.convolve(turns, np.ones(round(SHOWN / PERIOD)), mode="valid")
    return float(t[int(np.argmax(counts))])


if __name__ == "__main__":
    typer.run(main)
