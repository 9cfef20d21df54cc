"""pdoik diagnose, predict and replay from the shell's side."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("jinja2", reason="pip install 'pdoik[sim2real]'")

import pdoik.sim2real
from command_line import misuse, run
from pdoik import _files
from pdoik.sim2real import Diagnosis

FILES = {
    "report.html", "overview.png", "diagnosis.json", "model.json",
    "motions.npz", "improved.xml", "improved.urdf",
}  # fmt: skip


def table(path: Path) -> dict[str, np.ndarray]:
    names = path.read_text().split("\n", 1)[0].split(",")
    columns = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    return dict(zip(names, columns, strict=True))


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.fixture
def examined(examination: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The commands examine nothing anew."""
    monkeypatch.setattr(pdoik.sim2real, "examine", lambda study, **options: examination)
    return examination


@pytest.fixture(scope="module")
def report(example_study: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cli") / "new" / "report"
    invocation = run("diagnose", example_study, "--out", folder)
    assert invocation.exit_code == 0, invocation.output
    assert "payload" in invocation.stdout
    assert "Coulomb friction" in invocation.stdout
    assert "shoulder" in invocation.stdout
    assert invocation.stdout.splitlines()[-1] == str(folder / "report.html")
    for stage in ("read", "residual", "name", "replay", "cut-off", "report"):
        assert any(line.startswith(stage) for line in invocation.stderr.splitlines()), stage
    assert "Place(" not in invocation.stderr
    return folder


def test_diagnose_writes_a_whole_report(report: Path, examination: Any) -> None:
    assert {path.name for path in report.iterdir()} == {*FILES, "figures"}
    text = (report / "diagnosis.json").read_text()
    assert json.loads(text)["schema"] == "pdoik.diagnosis/1"
    assert Diagnosis.from_json(text) == examination.diagnosis
    page = (report / "report.html").read_text()
    for finding in examination.diagnosis.findings:
        assert finding.statement.split(",")[0] in page
    assert "closed-loop simulation" in page


def test_predict_and_replay_are_nearer_to_the_recording_with_the_findings(
    report: Path, example_study: Path, tmp_path: Path
) -> None:
    recording = example_study.parent / "friday.csv"
    recorded = table(recording)
    for command, channel in (("predict", "tau"), ("replay", "q")):
        off = []
        for options in ((), ("--without-findings",)):
            out = tmp_path / f"{command}{len(options)}.csv"
            done = run(command, report / "model.json", recording, "--out", out, *options)
            assert done.exit_code == 0, done.output
            assert done.stdout.strip() == str(out)
            came = table(out)
            assert came["time"] == pytest.approx(recorded["time"])
            off.append(rms(came[f"{channel}.shoulder"] - recorded[f"{channel}.shoulder"]))
        assert off[0] < 0.1 * off[1]


def test_other_names_and_kinds_predict_the_same_and_are_told_of(
    report: Path, example_study: Path, tmp_path: Path
) -> None:
    recorded = table(example_study.parent / "friday.csv")
    joints = ("base", "shoulder", "elbow")
    q = np.stack([recorded[f"q.{joint}"] for joint in joints], axis=1)
    np.savez(tmp_path / "a.npz", t=recorded["time"], actual_q=q)
    done = run("predict", report / "model.json", tmp_path / "a.npz", "--out", tmp_path / "a.csv")
    assert done.exit_code == 0, done.output
    assert "a.npz: column actual_q[0] read as q.base" in done.stderr
    assert "by the order of the joints that were named" in done.stderr
    (tmp_path / "b.csv").write_text(
        "\n".join(
            ",".join(map(str, row))
            for row in [
                ("time", *(f"q.{j}" for j in joints)),
                *zip(recorded["time"].tolist(), *q.T.tolist(), strict=True),
            ]
        )
    )
    plain = run("predict", report / "model.json", tmp_path / "b.csv", "--out", tmp_path / "p.csv")
    assert plain.exit_code == 0, plain.output
    assert not plain.stderr
    mine, theirs = table(tmp_path / "a.csv"), table(tmp_path / "p.csv")
    assert mine["tau.shoulder"] == pytest.approx(theirs["tau.shoulder"], abs=1e-9)


def test_commands_alone_are_enough_to_replay(
    report: Path, example_study: Path, tmp_path: Path
) -> None:
    recorded = table(example_study.parent / "friday.csv")
    names = [name for name in recorded if name == "time" or "_des." in name]
    rows = np.column_stack([recorded[name] for name in names])[:300]
    np.savetxt(
        tmp_path / "c.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g"
    )
    done = run("replay", report / "model.json", tmp_path / "c.csv", "--out", tmp_path / "r.csv")
    assert done.exit_code == 0, done.output
    came = table(tmp_path / "r.csv")
    assert came["q.elbow"] == pytest.approx(recorded["q.elbow"][:300], abs=0.02)
    assert {"time", "q.base", "dq.base", "tau.base", "q_des.base"} <= set(came)


@pytest.mark.usefixtures("examined")
def test_an_interrupted_report_is_started_again(
    example_study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename, folder = Path.replace, tmp_path / "report"

    def interrupted(path: Path, target: Path) -> Path:
        if target.name == "model.json":
            raise KeyboardInterrupt
        return rename(path, target)

    with monkeypatch.context() as patch:
        patch.setattr(_files.Path, "replace", interrupted)
        stopped = run("diagnose", example_study, "--out", folder, "--quick")
        assert stopped.exit_code not in (0, 2)
    assert {path.name for path in folder.iterdir()} == {"diagnosis.json"}  # what is known is kept
    again = run("diagnose", example_study, "--out", folder, "--quick")
    assert again.exit_code == 0, again.output
    assert {path.name for path in folder.iterdir()} >= FILES
    assert not list(folder.glob("figures/replay*"))


@pytest.mark.parametrize(
    ("command", "package"),
    [
        ("diagnose", "pinocchio"),
        ("diagnose", "jinja2"),
        ("predict", "pyarrow"),
        ("replay", "mujoco"),
    ],
)
def test_a_missing_package_says_what_to_install(
    command: str, package: str, example_study: Path, tmp_path: Path
) -> None:
    files = [str(example_study)] * (1 if command == "diagnose" else 2)
    program = (
        f"import sys; sys.modules[{package!r}] = None; from pdoik.cli import app;"
        f"app([{command!r}, *{files}, '--out', {str(tmp_path / 'out')!r}])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 2, done.stderr
    assert done.stderr.strip() == (
        f"error: {package} is not installed: pip install 'pdoik[sim2real]'"
    )


def test_misuse_of_diagnose_is_one_line(example_study: Path, tmp_path: Path) -> None:
    misuse(run("diagnose", tmp_path / "none.yaml"), "none.yaml", "no such file")
    misuse(run("diagnose", tmp_path), "is a folder")
    (tmp_path / "file").write_text("")
    misuse(run("diagnose", example_study, "--out", tmp_path / "file"), "--out", "is a file")
    bad = tmp_path / "study.yaml"
    bad.write_text("recordings: [{file: none.csv}]\n")
    misuse(run("diagnose", bad, "--out", tmp_path / "out"), "none.csv")
    assert not (tmp_path / "out").exists()
    text = example_study.read_text().replace("elbow]", "ellbow]")
    bad = example_study.parent / "misspelt.yaml"
    bad.write_text(text)
    misuse(run("diagnose", bad, "--out", tmp_path / "out"), "ellbow", "elbow")


@pytest.mark.parametrize("command", ["predict", "replay"])
def test_misuse_of_predict_and_replay_is_one_line(
    command: str, report: Path, example_study: Path, tmp_path: Path
) -> None:
    model, recording = report / "model.json", example_study.parent / "friday.csv"
    out = tmp_path / "out.csv"
    misuse(run(command, tmp_path / "m.json", recording, "--out", out), "m.json", "no such file")
    misuse(run(command, report, recording, "--out", out), "is a folder")
    misuse(run(command, model, recording, "--out", recording), "is also read")
    misuse(run(command, model, recording, "--out", tmp_path / "no/out.csv"), "no such folder")
    misuse(run(command, recording, recording, "--out", out), "friday.csv", "not JSON")
    other = tmp_path / "other.csv"
    other.write_text("time,q.base,q.shoulder,q.ellbow\n0,0,0,0\n0.01,0,0,0\n0.02,0,0,0\n")
    misuse(run(command, model, other, "--out", out), "elbow")
    assert not out.exists()


def test_a_recording_without_commands_or_torque_cannot_be_replayed(
    report: Path, tmp_path: Path
) -> None:
    still = tmp_path / "still.csv"
    rows = "\n".join(f"{0.01 * k:.2f},{0.01 * k},0,0" for k in range(400))
    still.write_text(f"time,q.base,q.shoulder,q.elbow\n{rows}\n")
    misuse(
        run("replay", report / "model.json", still, "--out", tmp_path / "o.csv"),
        "nothing to replay",
    )
