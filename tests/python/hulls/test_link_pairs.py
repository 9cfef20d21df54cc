"""Pairs of links by sampling: what is left out, what is not, and what coal says of the meshes."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import pdoik
from command_line import misuse, run
from pdoik.link_pairs import Mesh, meet, sample_pairs


def link(name: str, *boxes: tuple[str, str]) -> str:
    shapes = "".join(
        f'<collision><origin xyz="{xyz}"/><geometry><box size="{size}"/></geometry></collision>'
        for xyz, size in boxes
    )
    return f'<link name="{name}">{shapes}</link>'


def joint(name: str, parent: str, child: str, xyz: str, axis: str, bound: float) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
        f'<limit lower="-{bound}" upper="{bound}" effort="1" velocity="1"/></joint>'
    )


# An arm that folds in a plane: the fore arm can meet the base.
URDF = "".join(
    [
        '<robot name="folding">',
        link("base", ("0 0 0", "0.2 0.2 0.1")),
        link("upper", ("0.2 0 0.12", "0.4 0.06 0.06")),
        link("fore", ("0.15 0 0", "0.3 0.06 0.06")),
        link("hand", ("0.04 0 0", "0.08 0.06 0.06")),
        joint("shoulder", "base", "upper", "0 0 0.02", "0 0 1", 1.0),
        joint("elbow", "upper", "fore", "0.42 0 0.12", "0 1 0", 2.9),
        joint("wrist", "fore", "hand", "0.32 0 0", "0 0 1", 1.5),
        "</robot>",
    ]
)


ADJACENT = {("base", "upper"), ("fore", "upper"), ("fore", "hand")}


def wide_hulls() -> pdoik.Occupancy:
    """Balls far wider than the links."""
    return pdoik.Occupancy(
        spheres=[
            ("base", (0, 0, 0), 0.16),
            ("upper", (0.2, 0, 0.12), 0.22),
            ("fore", (0.15, 0, 0), 0.16),
            ("hand", (0.04, 0, 0), 0.07),
        ]
    )


def close_hulls() -> pdoik.Occupancy:
    return pdoik.Occupancy(
        capsules=[
            *(
                ("base", (-0.1, y, z), (0.1, y, z), 0.036)
                for y in (-0.075, -0.025, 0.025, 0.075)
                for z in (-0.025, 0.025)
            ),
            ("upper", (0, 0, 0.12), (0.4, 0, 0.12), 0.0425),
            ("fore", (0, 0, 0), (0.3, 0, 0), 0.0425),
            ("hand", (0, 0, 0), (0.08, 0, 0), 0.0425),
        ]
    )


def robot_with(occupancy: pdoik.Occupancy) -> pdoik.Robot:
    robot = pdoik.Robot.from_urdf(URDF, tip_link="hand")
    robot.occupancy = occupancy
    return robot


def coal_meet(a: np.ndarray, b: np.ndarray, T: np.ndarray) -> bool:
    coal = pytest.importorskip("coal")

    def tree(triangles: np.ndarray) -> object:
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(triangles), 3 * len(triangles))
        model.addVertices(triangles.reshape(-1, 3))
        model.addTriangles(np.arange(3 * len(triangles)).reshape(-1, 3))
        model.endModel()
        return model

    result = coal.CollisionResult()
    coal.collide(
        tree(a), coal.Transform3s(), tree(b), coal.Transform3s(T[:3, :3], T[:3, 3]),
        coal.CollisionRequest(), result,
    )  # fmt: skip
    return bool(result.isCollision())


def test_meshes_meet_where_coal_says_that_they_do() -> None:
    rng = np.random.default_rng(0)
    shapes = [
        trimesh.creation.box((0.3, 0.1, 0.2)),
        trimesh.creation.icosphere(2, 0.15),
        trimesh.creation.cylinder(0.05, 0.4, sections=16),
        trimesh.creation.annulus(0.1, 0.15, 0.1),
    ]
    meets = 0
    for _ in range(400):
        a, b = (np.asarray(shapes[k].triangles) for k in rng.integers(0, len(shapes), 2))
        T = np.eye(4)
        T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        T[:3, 3] = rng.normal(0, 0.15, 3)
        expected = coal_meet(a, b, T)
        assert meet(Mesh(a), Mesh(b), T) == expected
        meets += expected
    assert 100 < meets < 300


def test_pairs_that_never_meet_are_left_out_and_those_that_do_stay() -> None:
    report = sample_pairs(robot_with(wide_hulls()), URDF, samples=2000)
    words = {pair.links: pair.verdict for pair in report.pairs}
    counts = {pair.links: pair for pair in report.pairs}
    assert words["base", "fore"] == "Kept"
    assert counts["base", "fore"].meshes > 0
    assert {pair for pair, word in words.items() if word == "Adjacent"} == ADJACENT
    assert report.ignored == [pair for pair, word in words.items() if word != "Kept"]
    for pair in words.keys() - ADJACENT:
        assert (words[pair] == "Never") == (counts[pair].meshes == 0)
        assert counts[pair].hulls >= counts[pair].meshes
    assert report.free is not None
    assert 0 < report.free < report.samples


def test_no_collision_of_meshes_is_missed_and_closer_hulls_refuse_less() -> None:
    wide, close = (
        sample_pairs(robot_with(hulls), URDF, samples=2000)
        for hulls in (wide_hulls(), close_hulls())
    )
    assert close.flagged < 0.5 * wide.flagged
    for report in (wide, close):
        assert report.clearances[0].clearance == 0.0
        assert report.clearances[0].flagged == report.flagged
        assert report.clearances[0].missed == 0
        for more, less in zip(report.clearances, report.clearances[1:], strict=False):
            assert less.flagged <= more.flagged
            assert less.missed >= more.missed
    assert close.clearances[-1].flagged < close.flagged


def test_the_figures_are_those_of_the_solver_and_of_coal() -> None:
    """On other configurations, with the pairs that were found."""
    robot = robot_with(close_hulls())
    report = sample_pairs(robot, URDF, samples=1500)
    robot.ignored_pairs = report.ignored
    solver = pdoik.Solver(robot, pdoik.Options(self_collision=True))
    from pdoik.occupancy_fit import load_geometry

    meshes = {part.name: part.triangles for part in load_geometry(URDF)}
    pairs = [pair for pair in combinations(sorted(meshes), 2) if pair not in report.ignored]
    rng = np.random.default_rng(1)
    flagged = free = 0
    for _ in range(500):
        q = rng.uniform(robot.lower, robot.upper)
        poses = {name: robot.fk(q, name) for name in meshes}
        meets = any(
            coal_meet(meshes[a], meshes[b], np.linalg.inv(poses[a]) @ poses[b]) for a, b in pairs
        )
        refused = solver.judge(poses["hand"], q).self_distance < 0
        assert refused or not meets
        free += not meets
        flagged += refused and not meets
    assert flagged / free == pytest.approx(report.flagged_share, abs=0.03)


def test_without_meshes_only_what_hulls_say_is_left_out() -> None:
    robot = robot_with(wide_hulls())
    blind = sample_pairs(robot, samples=500)
    assert blind.free is None
    assert blind.clearances == ()
    always = {pair.links for pair in blind.pairs if pair.hulls >= 0.95 * 500}
    assert set(blind.ignored) == always | ADJACENT
    rest = [0.0, 2.8, 0.0]
    told = sample_pairs(robot, free=[rest], samples=500)
    at_rest = {tuple(sorted(pair)) for pair in pdoik.pairs_touching_at(robot, rest)}
    assert at_rest
    assert set(told.ignored) == always | at_rest | ADJACENT
    assert told.flagged < blind.flagged


def test_listed_pairs_stay_left_out_and_the_srdf_reads_back(tmp_path: Path) -> None:
    robot = robot_with(wide_hulls())
    report = sample_pairs(robot, URDF, listed=[("fore", "base")], samples=500)
    assert ("base", "fore") in report.ignored
    path = tmp_path / "folding.srdf"
    report.write(path)
    assert pdoik.load_srdf_pairs(path) == report.ignored
    robot.ignored_pairs = pdoik.load_srdf_pairs(path)
    again = sample_pairs(robot, URDF, samples=500)
    assert again.ignored == report.ignored
    assert again.flagged == report.flagged


def test_a_seed_gives_the_same_answer_and_misuse_is_refused() -> None:
    robot = robot_with(close_hulls())
    assert sample_pairs(robot, samples=200) == sample_pairs(robot, samples=200)
    with pytest.raises(ValueError, match="samples is 0"):
        sample_pairs(robot, samples=0)
    with pytest.raises(ValueError, match="no occupancy"):
        sample_pairs(robot_with(pdoik.Occupancy()))
    with pytest.raises(pdoik.LoadError):
        sample_pairs(robot, "<robot")


def test_the_command_line_writes_the_pairs(tmp_path: Path) -> None:
    urdf, hulls, out = (tmp_path / name for name in ("a.urdf", "a.yaml", "a.srdf"))
    urdf.write_text(URDF)
    wide_hulls().save(hulls)
    common = ("pairs", urdf, "--occupancy", hulls, "--samples", "300")
    outcome = run(*common, "--out", out)
    assert outcome.exit_code == 0, outcome.output
    assert "free configurations" in outcome.stdout
    assert "self_clearance -4 mm" in outcome.stdout
    expected = sample_pairs(robot_with(wide_hulls()), URDF, samples=300)
    assert pdoik.load_srdf_pairs(out) == expected.ignored
    blind = run(*common, "--no-meshes", "--srdf", out)
    assert blind.exit_code == 0, blind.output
    assert "Listed" in blind.stdout
    misuse(run(*common, "--out", tmp_path / "no" / "a.srdf"), "--out")
    misuse(run("pairs", "panda", "--occupancy", hulls), "shipped")
    misuse(run("pairs", urdf, "--occupancy", tmp_path / "none.yaml"), "none.yaml")
