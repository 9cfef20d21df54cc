"""The code of the README and of the documentation's pages runs as it stands."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

REPOSITORY = Path(__file__).parents[3]
DOCS = REPOSITORY / "python" / "docs"
TUTORIAL = DOCS / "tutorial.md"  # on a recording that is not in the repository
SHARED = Path(os.environ.get("PDOIK_SHARED", REPOSITORY.parent / "shared"))
INDEX = re.findall(r"^[a-z_]+$", (DOCS / "index.md").read_text(), re.MULTILINE)
PAGES = [
    page
    for page in (REPOSITORY / "README.md", *(DOCS / f"{name}.md" for name in INDEX))
    if page != TUTORIAL
]


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


def named(page: Path) -> str:
    return page.stem


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the Python examples have run, a page after the other."""
    pytest.importorskip("rosbags", reason="the extra sim2real is not installed")
    folder = tmp_path_factory.mktemp("readme")
    example = [sys.executable, str(REPOSITORY / "bench/sim2real/example.py"), "arm_study"]
    subprocess.run(example, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    for page in PAGES:
        if program := "\n".join(blocks(page, "python")):
            subprocess.run([sys.executable, "-W", "error", "-c", program], cwd=folder, check=True)
    return folder


def test_every_page_is_in_the_index() -> None:
    assert {f"{name}.md" for name in INDEX} == {page.name for page in DOCS.glob("*.md")} - {
        "index.md"
    }


def test_the_readme_is_read_in_minutes() -> None:
    assert len(PAGES[0].read_text().splitlines()) <= 200


def test_the_python_examples_run_and_write_what_they_say(examples: Path) -> None:
    pages = [named(page) for page in PAGES if blocks(page, "python")]
    solving = ["getting_started", "solve", "goals", "paths", "obstacles", "humanoid", "your_robot"]
    assert pages == ["README", *solving, "diagnose", "robot_logs", "watch"]
    assert sum(len(blocks(page, "python")) for page in PAGES) == 62
    for name in (
        "first.png",
        "arm.urdf",
        "scene.yaml",
        "report/diagnosis.json",
        "report/model.json",
    ):
        assert (examples / name).is_file(), name


def test_the_goals_pictures_are_those_of_the_page_and_come_of_its_code(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="the extra plot is not installed")
    names = ["five", "success"]
    command = [sys.executable, str(DOCS / "goals_pictures.py"), str(tmp_path), *names]
    subprocess.run(command, cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    assert {path.name for path in tmp_path.iterdir()} == {f"goals_{name}.png" for name in names}
    drawn = re.findall(
        r'^    "(\w+)": \w+,$', (DOCS / "goals_pictures.py").read_text(), re.MULTILINE
    )
    shown = re.findall(r"\(pictures/goals_(\w+)\.png\)", (DOCS / "goals.md").read_text())
    assert drawn == shown


def test_the_paths_pictures_are_those_of_the_page_and_come_of_its_code(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="the extra plot is not installed")
    names = ["closed", "costs"]
    command = [sys.executable, str(DOCS / "paths_pictures.py"), str(tmp_path), *names]
    subprocess.run(command, cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    written = {path.name for path in tmp_path.glob("*.png")}
    assert written == {f"paths_{name}.png" for name in names}
    drawn = re.findall(
        r'^    "(\w+)": \w+,$', (DOCS / "paths_pictures.py").read_text(), re.MULTILINE
    )
    shown = re.findall(r"\(pictures/paths_(\w+)\.png\)", (DOCS / "paths.md").read_text())
    assert drawn == shown


def test_the_command_lines_run_and_solve(examples: Path, tmp_path: Path) -> None:
    pdoik = shutil.which("pdoik", path=str(Path(sys.executable).parent))
    if pdoik is None:
        pytest.skip("the command pdoik is not installed beside this Python")
    shutil.copytree(examples, tmp_path, dirs_exist_ok=True)  # arm.urdf
    points = np.random.default_rng(0).uniform([0.5, -0.6, 0.0], [0.8, -0.3, 0.3], (500, 3))
    header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 500\nHEIGHT 1\n"
    rows = "\n".join(" ".join(map(str, row)) for row in points)
    (tmp_path / "scan.pcd").write_text(
        f"{header}VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 500\nDATA ascii\n{rows}\n"
    )
    written = (
        line for page in PAGES for block in blocks(page, "bash") for line in block.split("\n")
    )
    commands = [shlex.split(line, comments=True) for line in written if line.startswith("pdoik ")]
    lines = dict.fromkeys(tuple(words[1:]) for words in commands)  # each once
    assert {words[0] for words in lines} == {
        *("info", "solve", "report", "occupancy", "pairs", "bench", "view"),
        *("study", "effects", "diagnose", "compare", "predict", "simulate", "watch", "propose"),
    }
    for line in lines:
        words = list(line)
        # These take long: tested where they are written, and compare's line by a long test below.
        if words[0] in ("view", "compare"):
            words = [words[0], "--help"]
        if words[0] == "watch" and "--once" not in words:
            words += ["--once"]
        if words[0] == "bench":
            words += ["--targets", "20"]
        if words[0] == "propose":
            words += ["--search", "5"]
        done = subprocess.run([pdoik, *words], cwd=tmp_path, stdout=subprocess.DEVNULL)
        # The example's diagnosis may leave nothing open: then there is no motion to propose.
        assert done.returncode in ((0, 3) if words[0] == "propose" else (0,)), line
    assert (tmp_path / "out.png").exists()
    assert (tmp_path / "arm.occupancy.yaml").exists()


@pytest.mark.long
def test_the_comparisons_line_runs(examples: Path) -> None:
    (line,) = re.findall(r"^pdoik (compare .*)$", (DOCS / "compare.md").read_text(), re.MULTILINE)
    command = [sys.executable, "-m", "pdoik.cli", *shlex.split(line, comments=True)]
    subprocess.run(command, cwd=examples, check=True, stdout=subprocess.DEVNULL)


@pytest.mark.long
def test_the_tutorial_runs_on_its_recording(tmp_path: Path) -> None:
    pytest.importorskip("rosbags", reason="the extra sim2real is not installed")
    recording = SHARED / "recordings" / "ur10_unisa" / "run1.csv"
    if not recording.is_file():
        pytest.skip(f"the tutorial's recording is not there: {recording}")
    shutil.copy(recording, tmp_path / "ur10.csv")
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "MPLBACKEND": "agg"}
    program, printed = "", ""
    for language, code in re.findall(
        r"^```(python|bash)\n(.*?)^```", TUTORIAL.read_text(), re.DOTALL | re.MULTILINE
    ):
        program += code if language == "python" else ""
        command = ["bash", "-ec", code]
        if language == "python":
            command = [sys.executable, "-W", "error", "-c", program]
        printed = subprocess.run(
            command, cwd=tmp_path, env=environment, check=True, stdout=subprocess.PIPE, text=True
        ).stdout
    diagnosis = json.loads((tmp_path / "report" / "diagnosis.json").read_text())
    dry = ("coulomb_friction", "presliding_hysteresis")  # the latter bends before it slips
    rough = {f["joints"][0] for f in diagnosis["findings"] if f["effect"] in dry}
    assert len(rough) == 6
    assert all(joint["after"] < 0.5 * joint["before"] for joint in diagnosis["joints"].values())
    errors = [re.findall(r"[\d.]+(?= ->| N m)", line) for line in printed.splitlines()]
    assert len(errors) == 6
    assert all(float(improved) < 0.7 * float(given) for given, improved in errors)
    assert (tmp_path / "ur10_torque.png").is_file()


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "cpp")], ids=named)
def test_the_cpp_example_is_the_one_that_the_consumer_compiles(page: Path) -> None:
    (example,) = blocks(page, "cpp")
    compiled = (REPOSITORY / "tests/consumer/readme.cpp").read_text()
    lines = [line.strip() for line in example.splitlines() if line.strip()]
    program = [line.strip() for line in compiled.splitlines() if line.strip()]
    at = program.index(lines[1])
    assert lines[0] in program
    assert program[at : at + len(lines) - 1] == lines[1:]


@pytest.mark.parametrize("page", [*PAGES, TUTORIAL], ids=named)
def test_every_link_into_the_repository_leads_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)\)", page.read_text())
    assert links or page is not PAGES[0]
    gone = [each for each in links if "://" not in each and not (page.parent / each).exists()]
    assert not gone
