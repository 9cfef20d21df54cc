"""The picture of a diagnosis in the window: the page as headless Chromium shows it.

    python -m bench.sim2real.example arm_study
    pdoik diagnose arm_study/study.yaml --out report
    python -m bench.ik.window.diagnosis report FILE     (or any other report)

The machine as recorded, and simulated before and after the findings, some seconds into a
recording, with the finding of most weight at one joint opened.
"""

from pathlib import Path

import typer

from bench.ik.window.page import opened, save
from pdoik.view.diagnosis.report import load_report
from pdoik.view.diagnosis.viewer import DiagnosisViewer
from pdoik.view.server import start_server

AT = 0.45  # of the recording's length
TIMES = "1"  # by which differences of positions are drawn larger


def main(report: Path, out: Path) -> None:
    """Take the picture."""
    server = start_server("127.0.0.1", 0)
    viewer = DiagnosisViewer(server, load_report(report))
    try:
        findings = viewer.report.diagnosis.findings
        viewer.findings.choose(next((f for f in findings if len(f.joints) == 1), findings[0]))
        viewer.times.value = TIMES
        elapsed = round(AT * viewer.timeline.duration, 2)
        viewer.player.seek(elapsed)
        viewer.time.value = elapsed
        with opened(viewer, height=900) as page:
            viewer.show(elapsed)
            page.wait_for_timeout(8000)  # software rendering trails behind
            save(page.screenshot(timeout=120_000), out)
    finally:
        viewer.close()
        server.stop()


if __name__ == "__main__":
    typer.run(main)
