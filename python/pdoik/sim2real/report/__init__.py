"""The report of a diagnosis: one page, the same figures as PNG, and a picture for a README."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pdoik._files import write_whole
from pdoik.sim2real.findings import Diagnosis

from .data import CutoffInfluence, Hypothesis, RegimeMap, Replay, ReportData, Traces
from .joint_figure import joint_picture
from .overview import overview_png
from .page import Pictures, opened_joints, page
from .regimes import regime_map
from .replay_figure import replay_picture
from .study_figures import cutoff_picture, hypotheses_picture, joints_picture, regimes_picture
from .style import house_style

__all__ = [
    "CutoffInfluence",
    "Hypothesis",
    "RegimeMap",
    "Replay",
    "ReportData",
    "Traces",
    "render_report",
    "write_report",
]

POINTS = 14000  # samples in all clouds of one kind of panel: they make the page's size
MOST_REPLAYS = 3


def write_report(
    folder: Path,
    diagnosis: Diagnosis,
    evidence: ReportData,
    others: Mapping[str, str | bytes] | None = None,
) -> Path:
    """Write report.html, overview.png, figures/*.png and diagnosis.json; the page's path.

    Everything is drawn before the first file is written, and each file is whole or not there.
    diagnosis.json is the last: where it stands, the report is complete.

    Args:
        folder: Made if it is not there.
        diagnosis: What to say.
        evidence: What to show.
        others: More files by their path within the folder, as model.json and the improved model.

    Raises:
        ValueError: The evidence holds no recording.
        OSError: The folder cannot be made or written to.
    """
    files = {**render_report(diagnosis, evidence), **(others or {})}
    files["diagnosis.json"] = diagnosis.to_json()
    (folder / "diagnosis.json").unlink(missing_ok=True)
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(folder / name, content)
    return folder / "report.html"


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
        hypotheses=hypotheses_picture(data.hypotheses) if data.hypotheses else None,
        replays=tuple(
            replay_picture(data, replay, k) for k, replay in enumerate(data.replays[:MOST_REPLAYS])
        ),
        cutoff=cutoff_picture(data, data.cutoff) if data.cutoff is not None else None,
    )
