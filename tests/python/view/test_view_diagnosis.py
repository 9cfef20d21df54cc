"""A diagnosis opened in the window: what is drawn is what was recorded, simulated and found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from command_line import misuse, run

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("viser", reason="pip install 'pdoik[view]'")

from bench.sim2real import example
from pdoik.cli.report_folders import report_folder
from pdoik.errors import LoadError
from pdoik.sim2real import examine, write
from pdoik.sim2real.evidence import Motion, Motions
from pdoik.sim2real.report import Replay
from pdoik.view.diagnosis.report import Report, load_report
from pdoik.view.diagnosis.timeline import Timeline
from pdoik.view.diagnosis.viewer import DiagnosisViewer
from pdoik.view.server import start_server


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An arm whose elbow rubs and whose hand holds something."""
    folder = tmp_path_factory.mktemp("arm_study")
    example.main(folder)
    content = yaml.safe_load((folder / "study.yaml").read_text())
    content["recordings"] = [
        {"file": "monday.csv", "role": "fit", "window": [0.0, 8.0]},
        {"file": "friday.csv", "role": "validate", "window": [0.0, 6.0]},
    ]
    (folder / "study.yaml").write_text(yaml.safe_dump(content))
    return folder / "study.yaml"


@pytest.fixture(scope="module")
def report(study: Path) -> Report:
    folder = study.parent / "report"
    write(folder, examine(study), quick=False)
    return load_report(folder)


def test_simulated_with_the_findings_is_nearer_to_what_was_recorded(report: Report) -> None:
    friday = next(m for m in report.motions.motions if m.role == "validate")
    line = Timeline(friday)
    times = np.linspace(1.0, line.duration, 50)
    off = {
        which: np.array([line.q(which, t) - line.q("recorded", t) for t in times])
        for which in ("before", "after")
    }
    assert np.abs(off["after"]).max() < 0.1 * np.abs(off["before"]).max()
    three = np.array([line.q("before", t, 3.0) - line.q("recorded", t) for t in times])
    np.testing.assert_allclose(three, 3.0 * off["before"], atol=1e-6)
    size = {w: np.array([line.residual(w, t) for t in times]) for w in ("before", "after")}
    whole = np.sqrt(np.nanmean(friday.before**2, axis=0))
    assert (np.nanmean(size["after"], axis=0) < 0.3 * whole).all()


def test_what_is_put_back_again_and_again_is_judged_by_how_far_it_goes_between(
    report: Report, tmp_path: Path
) -> None:
    time = np.arange(0.0, 4.001, 0.01)
    q = np.sin(time)[:, None] * [1.0, 0.5, 0.2]
    since = time - 0.2 * np.clip(np.ceil(time / 0.2 - 1e-9) - 1, 0, None)  # put back [s]
    replay = Replay(
        recording="run.csv",
        time=time,
        recorded=q,
        before=q + 0.5 * since[:, None] * [1.0, -2.0, 0.0],
        after=q,
        how="so",
        horizon=0.2,
    )
    motion = Motion(name="run.csv", role="fit", time=time, q=q, before=q, after=q, replay=replay)
    whole = replace(report.motions, motions=(motion,))
    (tmp_path / "motions.npz").write_bytes(whole.to_bytes())
    for each in (motion, Motions.load(tmp_path).motions[0]):
        line = Timeline(each)
        assert line.horizon == 0.2
        np.testing.assert_allclose(line.departures["before"], [0.1, 0.2, 0.0], atol=1e-6)
        np.testing.assert_allclose(line.departures["after"], 0.0, atol=1e-6)


def test_the_page_moves_and_colours_links_as_recorded_simulated_and_found(report: Report) -> None:
    server = start_server("127.0.0.1", 0)
    viewer = DiagnosisViewer(server, report)
    try:
        viewer.show(3.0)
        drawn, line = viewer._drawn, viewer.timeline
        assert drawn is not None
        for name, copy in viewer.copies.items():
            T = drawn.robot.fk(line.q(name, 3.0), "forearm")
            np.testing.assert_allclose(copy._links["forearm"].position, T[:3, 3], atol=1e-9)
        red = {n: copy._links["upper_arm"].color for n, copy in viewer.copies.items()}
        assert red["before"][2] < 60 < 150 < red["after"][2]  # dark red, and pale
        payload = next(f for f in report.diagnosis.findings if "forearm" in f.links)
        friction = next(f for f in report.diagnosis.findings if f.effect == "coulomb_friction")
        for finding in (payload, friction):
            viewer.findings.choose(finding)
            assert finding.statement in viewer.findings.words.content
        assert viewer.joint == "elbow"
        assert viewer.copies["before"]._ring.visible

        other = next(m for m in viewer.recording.options if m != viewer.recording.value)
        viewer.recording.value = other
        viewer._choose()
        assert not viewer.timeline.simulated
        assert viewer.simulate.visible
        viewer._simulate()
        assert viewer.timeline.simulated, viewer.message.text
    finally:
        viewer.close()
        server.stop()


def test_a_report_is_named_by_its_folder_a_file_in_it_or_its_study(
    study: Path, report: Report, tmp_path: Path
) -> None:
    folder = report.folder
    for given in (folder, folder / "diagnosis.json", folder / "report.html", study):
        assert report_folder(str(given)) == folder
    for robot in ("panda", str(study.parent / "arm.urdf")):
        assert report_folder(robot) is None
    with pytest.raises(LoadError, match=r"without diagnosis\.json"):
        report_folder(str(tmp_path))
    alone = tmp_path / "study.yaml"
    alone.write_text(study.read_text())
    with pytest.raises(LoadError, match="pdoik diagnose"):
        report_folder(str(alone))


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("motions.npz", None, "pdoik diagnose"),
        ("motions.npz", b"PK garbage", "cannot be read"),
        ("diagnosis.json", b"{}", "diagnosis.json"),
        ("model.json", b"[", "model.json"),
    ],
)
def test_a_report_that_is_not_whole_is_refused_in_a_line(
    report: Report, tmp_path: Path, name: str, content: Any, said: str
) -> None:
    for each in ("diagnosis.json", "model.json", "motions.npz"):
        (tmp_path / each).write_bytes((report.folder / each).read_bytes())
    if content is None:
        (tmp_path / name).unlink()
    else:
        (tmp_path / name).write_bytes(content)
    misuse(run("view", tmp_path, "--no-open", "--port", "0"), said)
