"""Every command of bench/ in small, and the tables that its READMEs take from reports."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("dask", reason="pip install 'pdoik[bench]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")

from bench.common.publish import PublishError, published

REPOSITORY = Path(__file__).parents[3]
SHARED = Path(os.environ.get("PDOIK_SHARED", REPOSITORY.parent / "shared"))
READMES = sorted((REPOSITORY / "bench").rglob("README.md"))
BY_PATH = {"bench.sim2real.frame.one", "bench.ik.clouds.trials"}  # parts of others, not for hands

COMMANDS = sorted(
    ".".join(path.relative_to(REPOSITORY).with_suffix("").parts).removesuffix(".__main__")
    for path in (REPOSITORY / "bench").rglob("*.py")
    if '__name__ == "__main__"' in path.read_text()
)

SMALL = {  # what no other test runs
    "bench.ik.compare": "--targets 20 --scenes 3 --robot panda",
    "bench.ik.deadlines": "--quick --out {out} --robot panda --count 1000",
    "bench.sim2real.diagnosis.visible": "--quick --out {out}",
    "bench.sim2real.legged": "--out {out} --count 1 --robot go2 --background plain",
    "bench.sim2real.loop": "--quick --out {out} --workers 1",
    "bench.sim2real.proof.peers_run": "--quick --out {out} --workers 1",
    "bench.sim2real.propose": "--quick --out {out}",
    "bench.sim2real.simulators.sealed": "--out {out} --seed 3 --count 1",
    "bench.sim2real.propose.legged": "--quick --out {out}",
}


@pytest.mark.filterwarnings("ignore:.*found in sys.modules:RuntimeWarning")
@pytest.mark.parametrize("command", [name for name in COMMANDS if name not in BY_PATH])
def test_a_command_says_what_it_does(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [command, "--help"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(command, run_name="__main__", alter_sys=False)
    assert ended.value.code == 0
    assert len(capsys.readouterr().out.splitlines()) > 3


@pytest.mark.long
@pytest.mark.parametrize("command", SMALL)
def test_a_command_in_small(command: str, tmp_path: Path) -> None:
    words = SMALL[command].format(out=tmp_path / "out").split()
    done = subprocess.run(
        [sys.executable, "-m", command, *words],
        cwd=REPOSITORY, capture_output=True, text=True, check=False, timeout=1800,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "|" in done.stdout


# Tables in READMEs

REPORT = """\
- command: python -m bench.ik.tracking --runs 1
- commit: 1a2b3c4
- processor: one
- load before: 0.10

Seed 0.

| arm | n |
| --- | ---: |
| ur10 | 3 |

## By speed

**Slow**, up to 1 m/s

| arm | n |
| --- | ---: |
| ur10 | 2 |
"""
README = """\
Before.

<!-- bench.ik.tracking -->
<!-- end -->

<!-- bench.ik.hard -->
kept
<!-- end -->

<!-- bench.ik.tracking: slow -->
*old*

| old |
<!-- end -->
After."""


def test_tables_go_between_their_own_markers_and_say_where_they_were_measured() -> None:
    text, count = published(REPORT, README)
    assert count == 2
    first, other, second = re.findall(r"<!-- bench.*?<!-- end -->", text, re.DOTALL)
    assert "| ur10 | 3 |" in first
    assert "commit: 1a2b3c4; processor: one; load before: 0.10*" in first
    assert "kept" in other
    assert "| ur10 | 2 |" in second
    assert "old" not in second
    assert text.startswith("Before.\n")
    assert text.endswith("\nAfter.")
    assert published(REPORT, text) == (text, 2)


@pytest.mark.parametrize(
    ("report", "message"),
    [
        (REPORT.replace("**Slow**", "**Quick**"), "no table 'slow'"),
        (REPORT.replace("- commit: 1a2b3c4\n", ""), "does not say: commit"),
        ("", "does not say: command, commit"),
    ],
)
def test_what_cannot_be_published_is_said(report: str, message: str) -> None:
    with pytest.raises(PublishError, match=message):
        published(report, README)


def test_every_published_table_names_a_command_commit_machine_and_load() -> None:
    blocks = [
        (path, match)
        for path in READMES
        for match in re.finditer(
            r"<!-- (bench[.\w]+)(?:: .*?)? -->\n(.*?)<!-- end -->", path.read_text(), re.DOTALL
        )
    ]
    assert len(blocks) > 25
    for path, match in blocks:
        assert match[1] in COMMANDS, path
        line = match[2].partition("\n")[0]
        for fact in (f"command: python -m {match[1]}", "commit: ", "processor: ", "load before: "):
            assert fact in line, (path, match[1])


def test_every_command_is_told_of_in_a_readme() -> None:
    text = "\n".join(path.read_text() for path in [*READMES, REPOSITORY / "README.md"])
    silent = [name for name in COMMANDS if name not in BY_PATH and f"python -m {name}" not in text]
    assert silent == []
