"""The README's code runs as it stands."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

REPOSITORY = Path(__file__).parents[2]
README = (REPOSITORY / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the Python examples have run, one after the other."""
    pytest.importorskip("rosbags", reason="the extra sim2real is not installed")
    folder = tmp_path_factory.mktemp("readme")
    example = [sys.executable, str(REPOSITORY / "bench/diagnose_example.py"), "arm_study"]
    subprocess.run(example, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    program = "\n".join(blocks("python"))
    subprocess.run([sys.executable, "-W", "error", "-c", program], cwd=folder, check=True)
    return folder


def test_the_python_examples_run_and_write_what_they_say(examples: Path) -> None:
    assert len(blocks("python")) == 9
    for name in ("arm.urdf", "scene.yaml", "report/diagnosis.json", "report/model.json"):
        assert (examples / name).is_file(), name


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
    lines = [
        line for block in blocks("bash") for line in block.splitlines() if line.startswith("pdoik ")
    ]
    assert {shlex.split(line)[1] for line in lines} == {
        *("info", "solve", "occupancy", "pairs", "bench", "view", "h1"),
        *("study", "diagnose", "compare", "predict", "replay", "watch", "propose"),
    }
    for line in lines:
        words = shlex.split(line, comments=True)[1:]
        if words[0] in ("view", "h1"):  # these go on and on: tested where they are written
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


def test_the_cpp_example_is_the_one_that_the_consumer_compiles() -> None:
    (example,) = blocks("cpp")
    compiled = (REPOSITORY / "tests/consumer/readme.cpp").read_text()
    lines = [line.strip() for line in example.splitlines() if line.strip()]
    program = [line.strip() for line in compiled.splitlines() if line.strip()]
    at = program.index(lines[1])
    assert lines[0] in program
    assert program[at : at + len(lines) - 1] == lines[1:]


def test_every_link_into_the_repository_leads_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert links
    assert not [link for link in links if "://" not in link and not (REPOSITORY / link).exists()]
