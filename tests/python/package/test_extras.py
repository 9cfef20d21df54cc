"""What pdoik does with NumPy alone, and how it asks for what is missing."""

from __future__ import annotations

import ast
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import pdoik

OTHERS = ("matplotlib", "mujoco", "pinocchio", "pypcd4", "rich", "scipy", "trimesh", "typer")
OTHERS += ("PIL", "h5py", "jinja2", "pyarrow", "rosbags", "viser", "xacro", "yaml")
PYPROJECT = Path(__file__).parents[3] / "pyproject.toml"
PACKAGE_OF = {"PIL": "pillow", "collada": "pycollada", "pinocchio": "pin", "yaml": "pyyaml"}
PACKAGE_OF |= {"igl": "libigl", "mpl_toolkits": "matplotlib", "mapbox_earcut": "mapbox-earcut"}
BY_CHOICE = {"distributed", "example_robot_data", "robot_descriptions"}  # users bring these


def without_others(
    program: str, others: tuple[str, ...] = OTHERS
) -> subprocess.CompletedProcess[str]:
    """Run where these packages are not; by default NumPy is the only one of others."""
    hide = f"import sys\nfor name in {others}: sys.modules[name] = None\n"
    return subprocess.run([sys.executable, "-c", hide + program], capture_output=True, text=True)


def test_numpy_is_enough_to_solve_follow_and_keep_clear() -> None:
    done = without_others("""
import numpy as np, pdoik
robot = pdoik.Robot.builtin("panda")
target = robot.fk(robot.mid_configuration())
far = np.random.default_rng(0).uniform(1.0, 2.0, (500, 3))
solver = pdoik.Solver(robot)
solved = solver.solve(target, obstacles=pdoik.Cloud(pdoik.voxel_downsample(far, 0.05)))
tracker = pdoik.Tracker(solver, period=0.001)
tracker.reset(solved.q)
print(solved.success, tracker.step(target).q.shape)
""")
    assert done.stdout.split() == ["True", "(7,)"], done.stderr


@pytest.mark.parametrize(
    ("program", "package", "extra"),
    [
        ("pdoik.load_scene('s.yaml')", "yaml", "files"),
        ("pdoik.clouds.load_cloud('c.pcd')", "pypcd4", "files"),
        ("pdoik.load_robot('r.xacro')", "xacro", "files"),
        ("from pdoik.occupancy_fit import fit_occupancy", "scipy", "files"),
        ("from pdoik.sim2real import diagnose", "scipy", "sim2real"),
        ("from pdoik.picture import draw_solution", "matplotlib", "plot"),
    ],
)
def test_what_is_missing_is_asked_for_by_its_extra(
    program: str, package: str, extra: str, tmp_path: Path
) -> None:
    (tmp_path / "s.yaml").write_text("schema: pdoik.scene/1\nshapes: []\n")
    (tmp_path / "c.pcd").write_text("VERSION .7\n")
    (tmp_path / "r.xacro").write_text("<robot name='r'/>")
    start = f"import os; os.chdir({str(tmp_path)!r}); import pdoik, pdoik.clouds\n"
    done = without_others(start + program)
    last = done.stderr.strip().splitlines()[-1]
    assert last == (
        f"pdoik.errors.MissingExtraError: {package} is not installed: pip install 'pdoik[{extra}]'"
    )


def test_pictures_take_their_own_extra_alone(tmp_path: Path) -> None:
    hidden = tuple(name for name in OTHERS if name not in ("PIL", "matplotlib", "trimesh"))
    done = without_others(
        f"""
import pdoik
from pdoik.picture import draw_solution
solver = pdoik.Solver(pdoik.Robot.builtin("panda"))
shapes = [
    pdoik.Shape.half_space("floor", (0, 0, 1), (0, 0, -0.2)),
    pdoik.Shape.cylinder("can", 0.1, 0.2), pdoik.Shape.capsule("pill", 0.1, 0.2),
    pdoik.Shape.sphere("ball", (1, 0, 0), 0.1), pdoik.Shape.box("box", (1, 1, 1)),
    pdoik.Shape.boxes("boxes", [[0, 0, 0]], [[1, 1, 1]]),
    pdoik.Shape.convex_mesh(
        "rock", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], None,
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    ),
]
q = solver.robot.mid_configuration()
result = solver.judge(solver.robot.fk(q), q, shapes)
draw_solution({str(tmp_path / "a.png")!r}, solver, result, solver.robot.fk(q), shapes, dpi=40)
""",
        hidden,
    )
    assert not done.returncode, done.stderr
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_the_command_line_asks_for_its_own() -> None:
    done = without_others("from pdoik.cli import main; main()")
    assert done.returncode == 2
    assert done.stderr.strip() == ("error: the command line needs typer: pip install 'pdoik[cli]'")


@pytest.mark.parametrize(
    "command", ["solve --robot panda --target '0.4 0.1 0.5 1 0 0 0'", "info panda", ""]
)
def test_the_command_line_takes_its_own_extra_alone(command: str) -> None:
    hidden = tuple(name for name in OTHERS if name not in ("rich", "typer"))
    done = without_others(
        f"sys.argv[1:] = {shlex.split(command)}; from pdoik.cli import main; main()",
        hidden,
    )
    assert done.returncode == 0, done.stderr


def test_all_that_is_imported_is_in_the_extra_all() -> None:
    project = tomllib.loads(PYPROJECT.read_text())["project"]
    extras = project["optional-dependencies"]
    assert project["dependencies"] == ["numpy>=1.26"]
    (everything,) = extras["all"]
    names = re.search(r"\[(.*)\]", everything)[1].split(",")  # type: ignore[index]
    told = {re.split(r"[\[>=]", each)[0] for name in names for each in extras[name]}
    found = set()
    for file in Path(pdoik.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                found |= {each.name.partition(".")[0] for each in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                found.add(node.module.partition(".")[0])
    found -= {*sys.stdlib_module_names, "pdoik", "numpy", *BY_CHOICE}
    assert {PACKAGE_OF.get(name, name) for name in found} <= told


def test_what_solves_is_imported_alone_and_the_rest_when_asked_for() -> None:
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys, pdoik\n"
            "pdoik.Solver(pdoik.Robot.builtin('panda'))\n"
            "parts = {'reports', 'scenes', 'descriptions', 'reach_map', 'clouds', 'sim2real'}\n"
            "early = sorted(part for part in parts if f'pdoik.{part}' in sys.modules)\n"
            "assert {*pdoik.__all__, '__version__', 'scenes'} <= set(dir(pdoik))\n"
            "from pdoik import *\n"
            "print(early, load_scene is pdoik.scenes.load_scene, Grid.__name__)\n"
            "pdoik.load_scenes",
        ],
        capture_output=True,
        text=True,
    )
    assert done.stdout == "[] True Grid\n", done.stderr
    assert "module 'pdoik' has no attribute 'load_scenes'" in done.stderr
