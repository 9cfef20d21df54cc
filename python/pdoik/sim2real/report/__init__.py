"""The report of a diagnosis: one page, the same figures as PNG, and a picture for a README."""

from __future__ import annotations

from pdoik.sim2real.findings import Diagnosis

from .curves import binned, busiest, envelope, reach
from .data import CutoffInfluence, Hypothesis, RegimeMap, Replay, ReportData, Traces
from .drive_figure import drives_picture
from .joint_figure import joint_picture
from .matrix import Matrix, cell, heading, line, matrix_of
from .overview import overview_png
from .page import Pictures, opened_joints, page
from .regimes import regime_map
from .replay_figure import replay_picture
from .study_figures import cutoff_picture, hypotheses_picture, joints_picture, regimes_picture
from .style import AFTER, BEFORE, MEASURED, Picture, house_style, picture, png_of, short
from .words import (
    VERDICTS,
    changes_words,
    effect_name,
    estimate_numbers,
    joint_state,
    number,
    parameters_of,
    percent,
    place,
    residue_words,
    suspected_words,
)

POINTS = 14000  # samples in all clouds of one kind of panel: they make the page's size
MOST_REPLAYS = 3


def render_report(diagnosis: Diagnosis, evidence: ReportData) -> dict[str, str | bytes]:
    """The files of a report by their path within the folder; the page is the last."""
    if not evidence.recordings:
        raise ValueError("evidence.recordings is empty, a report shows at least one")
    with house_style():
        pictures = draw_pictures(diagnosis, evidence)
        overview = overview_png(diagnosis, evidence)
    files: dict[str, str | bytes] = {f"figures/{each.name}.png": each.png for each in pictures.all}
    files["overview.png"] = overview
    files["report.html"] = page(diagnosis, evidence, pictures)
    return files


def cloud_size(joints: int) -> int:
    """How many samples a cloud of a joint's figure may hold."""
    return max(250, min(2500, POINTS // max(joints, 1)))


def draw_pictures(diagnosis: Diagnosis, data: ReportData) -> Pictures:
    """The page's figures; within `house_style`."""
    n = len(data.joints)
    regimes = data.regimes if data.regimes is not None else regime_map(data)
    return Pictures(
        joints=joints_picture(diagnosis),
        regimes=regimes_picture(data, regimes, diagnosis.joints),
        by_joint=tuple(joint_picture(data, joint, cloud_size(n)) for joint in range(n)),
        opened=opened_joints(diagnosis, data.joints),
        drives=drives_picture(diagnosis, data),
        hypotheses=hypotheses_picture(data.hypotheses) if data.hypotheses else None,
        replays=tuple(
            replay_picture(data, replay, k) for k, replay in enumerate(data.replays[:MOST_REPLAYS])
        ),
        cutoff=cutoff_picture(data, data.cutoff) if data.cutoff is not None else None,
    )


__all__ = [
    "AFTER",
    "BEFORE",
    "MEASURED",
    "VERDICTS",
    "CutoffInfluence",
    "Hypothesis",
    "Matrix",
    "Picture",
    "Pictures",
    "RegimeMap",
    "Replay",
    "ReportData",
    "Traces",
    "binned",
    "busiest",
    "cell",
    "changes_words",
    "drives_picture",
    "effect_name",
    "envelope",
    "estimate_numbers",
    "heading",
    "house_style",
    "joint_picture",
    "joint_state",
    "line",
    "matrix_of",
    "number",
    "page",
    "parameters_of",
    "percent",
    "picture",
    "place",
    "png_of",
    "reach",
    "regime_map",
    "render_report",
    "residue_words",
    "short",
    "suspected_words",
]
