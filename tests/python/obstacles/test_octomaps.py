"""OctoMaps as obstacles, against the library that writes them."""

from __future__ import annotations

import itertools
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import pdoik
from pdoik._octomaps import boxes_of
from pdoik._octree import OctreeError, octree_of_data, read_octree

pyoctomap = pytest.importorskip("pyoctomap")

RESOLUTION = 0.1
RNG = np.random.default_rng(11)


def a_tree(kind: str = "OcTree") -> Any:
    """A solid block, scattered cells, and free space between them."""
    tree = getattr(pyoctomap, kind)(RESOLUTION)
    for cell in itertools.product(range(-3, 13), range(8), range(8)):
        tree.updateNode((np.array(cell) + 0.5) * RESOLUTION, True)  # large enough to be pruned
    for point in RNG.uniform([-2, -2, -1], [2, 2, 1], (400, 3)):
        tree.updateNode(point, bool(RNG.random() < 0.4))
    for cell in itertools.product(range(4), range(-16, -8), range(4)):
        tree.updateNode((np.array(cell) + 0.5) * RESOLUTION, False)
    tree.updateInnerOccupancy()
    return tree


def written(tree: Any, path: Path) -> Path:
    assert (tree.writeBinary if path.suffix == ".bt" else tree.write)(str(path))
    return path


def said_of(tree: Any, points: np.ndarray) -> np.ndarray:
    """What the library says of places: 1 taken, 0 free, -1 unknown."""
    found = (tree.search(point) for point in points)
    return np.array([-1 if node is None else int(tree.isNodeOccupied(node)) for node in found])


def holds(shape: pdoik.Shape, points: np.ndarray) -> np.ndarray:
    """How many of its boxes each place is in."""
    low, high = shape.vertices[0::2], shape.vertices[1::2]
    inside = (points[:, None] > low) & (points[:, None] < high)
    return inside.all(axis=2).sum(axis=1)


def off_the_faces(count: int, low: Any, high: Any) -> np.ndarray:
    points = RNG.uniform(low, high, (count, 3))
    from_face = np.abs(points / RESOLUTION - np.rint(points / RESOLUTION)).min(axis=1)
    return points[from_face > 1e-3]


@pytest.mark.parametrize("kind", ["OcTree", "ColorOcTree", "OcTreeStamped"])
@pytest.mark.parametrize("suffix", [".bt", ".ot"])
def test_what_is_taken_is_what_the_library_says(tmp_path: Path, kind: str, suffix: str) -> None:
    tree = a_tree(kind)
    path = written(tree, tmp_path / f"map{suffix}")
    points = off_the_faces(4000, [-2.5, -2.5, -1.5], [2.5, 2.5, 1.5])
    said = said_of(tree, points)
    assert np.unique(said).tolist() == [-1, 0, 1]
    shape = pdoik.Shape.octomap("room", path)
    assert (shape.name, shape.kind) == ("room", "boxes")
    np.testing.assert_array_equal(holds(shape, points), said == 1)
    assert len(shape.vertices) // 2 < read_octree(path.read_bytes()).taken.sum()


def test_the_leaves_are_those_of_the_library(tmp_path: Path) -> None:
    tree = a_tree()
    ours = read_octree(written(tree, tmp_path / "map.ot").read_bytes())
    theirs = sorted(
        (*np.rint(np.array(leaf.getCoordinate()) / RESOLUTION * 2).astype(int).tolist(),
         round(leaf.getSize() / RESOLUTION), bool(tree.isNodeOccupied(leaf)))
        for leaf in tree.begin_leafs()
    )  # fmt: skip
    found = zip((2 * ours.low + ours.size[:, None]).tolist(), ours.size.tolist(),
                ours.taken.tolist(), strict=True)  # fmt: skip
    assert sorted((*middle, size, taken) for middle, size, taken in found) == theirs
    assert ours.size.max() == 4


@pytest.mark.parametrize("suffix", [".bt", ".ot"])
def test_what_is_unknown_is_taken_where_that_is_asked(tmp_path: Path, suffix: str) -> None:
    tree = a_tree()
    path = written(tree, tmp_path / f"map{suffix}")
    leaves = read_octree(path.read_bytes())
    low = leaves.low.min(axis=0) * RESOLUTION
    high = (leaves.low + leaves.size[:, None]).max(axis=0) * RESOLUTION
    points = off_the_faces(4000, low - 0.3, high + 0.3)
    said = said_of(tree, points)
    bounded = ((points > low) & (points < high)).all(axis=1)
    shape = pdoik.Shape.octomap("room", path, unknown=True)
    np.testing.assert_array_equal(holds(shape, points), bounded & (said != 0))

    region = np.array([[-0.55, -1.23, -0.4], [1.02, 0.71, 0.9]])
    inside = ((points > region[0]) & (points < region[1])).all(axis=1)
    for unknown, taken in ((False, said == 1), (True, said != 0)):
        shape = pdoik.Shape.octomap("room", path, unknown=unknown, region=region)
        np.testing.assert_array_equal(holds(shape, points), inside & taken)


def test_a_large_map_is_put_together_block_by_block(tmp_path: Path) -> None:
    tree = pyoctomap.OcTree(0.05)
    for x in np.arange(-20.0, 20.0, 0.05) + 0.025:  # a wall of 40 m by 0.4 m, one cell thick
        for z in np.arange(0, 0.4, 0.05) + 0.025:
            tree.updateNode(np.array([x, 3.025, z]), True)
    shape = pdoik.Shape.octomap("wall", written(tree, tmp_path / "wall.bt"))
    edges = shape.vertices[1::2] - shape.vertices[0::2]
    assert edges.prod(axis=1).sum() == pytest.approx(40 * 0.4 * 0.05)
    assert len(edges) <= 2 + 40 / (128 * 0.05)
    T = np.eye(4)
    T[:3, 3] = 0, 0, 1
    moved = pdoik.Shape.octomap("wall", tmp_path / "wall.bt", T)
    np.testing.assert_array_equal(moved.T_base_shape, T)


def test_leaves_larger_than_a_block_are_boxes_as_they_are() -> None:
    # The root's first child is taken, its second one free, the third has one taken child.
    data = bytes([0b00_11_01_10, 0, 0b10, 0])
    tree = octree_of_data(data, "OcTree", 0.001, binary=True)
    np.testing.assert_array_equal(tree.size, [32768, 32768, 16384])
    low, high = boxes_of(tree)
    half = 32.768
    np.testing.assert_allclose(low, [[-half, -half, -half], [-half, 0, -half]])
    np.testing.assert_allclose(high, [[0, 0, 0], [-half / 2, half / 2, -half / 2]])
    region = [[-0.5, -0.5, -0.3], [0.2, 0.25, -0.1]]  # across three of the root's children
    low, high = boxes_of(tree, unknown=True, region=region)
    volume = (0.5 * 0.5 + 0.5 * 0.25 + 0.2 * 0.25) * 0.2
    assert (high - low).prod(axis=1).sum() == pytest.approx(volume)


def test_a_solver_keeps_off_a_map(tmp_path: Path) -> None:
    tree = pyoctomap.OcTree(0.02)
    for cell in itertools.product(range(20, 30), range(-10, 10), range(30)):
        tree.updateNode((np.array(cell) + 0.5) * 0.02, True)
    (scene_shape,) = pdoik.load_scene(written(tree, tmp_path / "pillar.bt")).shapes
    assert scene_shape.name == "pillar"
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    T = np.eye(4)
    T[:3, 3] = 0.5, 0, 0.3
    boxed = pdoik.Shape.box("pillar", [0.2, 0.4, 0.6], T)
    solved = 0
    for _ in range(20):
        q = RNG.uniform(robot.lower, robot.upper)
        result = solver.solve(robot.fk(q), obstacles=[scene_shape])
        if result.success:
            solved += 1
            assert solver.judge(robot.fk(q), result.q, obstacles=[boxed]).success
    assert solved >= 5


# In scenes.


def test_scene_files_name_maps(tmp_path: Path) -> None:
    tree = a_tree()
    written(tree, tmp_path / "map.bt")
    region = [[0, 0, 0], [0.5, 0.5, 0.5]]
    content = {
        "shapes": [
            {"name": "all", "octomap": "map.bt", "position": [1, 2, 3]},
            {"name": "part", "octomap": {"file": "map.bt", "unknown": True, "region": region}},
        ]
    }
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(content))
    whole, part = pdoik.load_scene(path).shapes
    expected = pdoik.Shape.octomap("all", tmp_path / "map.bt")
    np.testing.assert_array_equal(whole.vertices, expected.vertices)
    np.testing.assert_array_equal(whole.T_base_shape[:3, 3], (1, 2, 3))
    assert part.vertices.min() >= 0
    assert part.vertices.max() <= 0.5
    pdoik.save_scene(pdoik.load_scene(path), tmp_path / "again.yaml")
    again = pdoik.load_scene(tmp_path / "again.yaml").shapes[0]
    np.testing.assert_array_equal(again.vertices, whole.vertices)


def message_of(tree: Any, folder: Path, binary: bool) -> bytes:
    """The data of an octomap_msgs/Octomap: a file without its header."""
    path = written(tree, folder / f"data{'.bt' if binary else '.ot'}")
    return path.read_bytes().partition(b"\ndata\n")[2]


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("packed", [True, False])
def test_moveits_octomap_is_read(tmp_path: Path, binary: bool, packed: bool) -> None:
    tree = a_tree()
    data = message_of(tree, tmp_path, binary)
    said: Any = np.frombuffer(data, np.int8).tolist()
    if packed:
        said = zlib.compress(data).hex().upper()
    octomap = {
        "header": {"frame_id": "map"},
        "origin": {"position": [0.5, 0, 0], "orientation": [0, 0, 0, 1]},
        "octomap": {"binary": str(binary).lower(), "id": "OcTree", "resolution": RESOLUTION,
                    "data": said},
    }  # fmt: skip
    frames = [{"child_frame_id": "map", "transform": {"translation": [0, 1, 0]}}]
    matrix = {"entry_names": ["hand", "<octomap>"], "entry_values": [[True, True], [True, True]]}
    content = {
        "fixed_frame_transforms": frames,
        "allowed_collision_matrix": matrix,
        "world": {"octomap": octomap},
    }
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(content))
    scene = pdoik.load_scene(path)
    (shape,) = scene.shapes
    np.testing.assert_array_equal(shape.T_base_shape[:3, 3], (0.5, 1, 0))
    expected = pdoik.Shape.octomap("it", tmp_path / f"data{'.bt' if binary else '.ot'}")
    np.testing.assert_array_equal(shape.vertices, expected.vertices)
    assert scene.allowed == [("hand", "<octomap>")]
    for key, value, says in (
        ("data", "12zz", r"world.octomap.octomap.data: expected a list of bytes"),
        ("resolution", 0, r"world.octomap.octomap: expected a resolution above 0 m"),
        ("binary", "maybe", r"octomap.binary: expected true or false"),
        ("id", "SemanticOcTree", r"class is 'SemanticOcTree', expected one of OcTree"),
    ):
        bad = {**octomap, "octomap": {**octomap["octomap"], key: value}}
        path.write_text(yaml.safe_dump({"world": {"octomap": bad}}))
        with pytest.raises(pdoik.LoadError, match=rf"scene.yaml: .*{says}"):
            pdoik.load_scene(path)


# What is refused.


def test_maps_in_which_nothing_is_taken_are_refused(tmp_path: Path) -> None:
    tree = pyoctomap.OcTree(0.1)
    for point in RNG.uniform(-1, 1, (50, 3)):
        tree.updateNode(point, False)
    path = written(tree, tmp_path / "free.bt")
    with pytest.raises(pdoik.LoadError, match=r"free.bt: nothing is taken"):
        pdoik.Shape.octomap("it", path)
    written(a_tree(), path)
    far = [[50, 50, 50], [51, 51, 51]]
    with pytest.raises(pdoik.LoadError, match=r"free.bt: nothing in the region is taken"):
        pdoik.Shape.octomap("it", path, region=far)
    assert len(pdoik.Shape.octomap("it", path, region=far, unknown=True).vertices) == 2
    with pytest.raises(pdoik.LoadError, match=r"expected a region of the lowest and the highest"):
        pdoik.Shape.octomap("it", path, region=[[1, 1, 1], [0, 2, 2]])
    with pytest.raises(pdoik.LoadError, match=r"unknown is too much"):
        pdoik.Shape.octomap("it", path, region=[[-500] * 3, [500] * 3], unknown=True)


@pytest.mark.parametrize("suffix", [".bt", ".ot"])
def test_files_cut_anywhere_or_of_other_kinds_are_refused(tmp_path: Path, suffix: str) -> None:
    content = written(a_tree(), tmp_path / f"map{suffix}").read_bytes()
    for cut in RNG.integers(0, len(content) - 1, 60):
        with pytest.raises(OctreeError):
            read_octree(content[:cut])
    for old, new, says in (
        (b"# Octomap", b"# Ottomap", "no OctoMap file"),
        (b"id OcTree", b"id Tree", "class is 'Tree'"),
        (b"res 0.1", b"res -1", "resolution above 0"),
        (b"res 0.1", b"res nan", "resolution above 0"),
        (b"res 0.1", b"res wide", "is no number"),
        (b"size ", b"size 9", "promises 9"),
        (b"res 0.1\n", b"", "expected id, size, res"),
    ):
        with pytest.raises(OctreeError, match=says):
            read_octree(content.replace(old, new, 1))


def test_a_tree_that_is_too_deep_is_refused() -> None:
    with pytest.raises(OctreeError, match="deeper than 16"):
        octree_of_data(b"\x03\x00" * 30, "OcTree", 0.1, binary=True)
    with pytest.raises(OctreeError, match="deeper than 16"):
        octree_of_data(b"\x00\x00\x00\x00\x01" * 30, "OcTree", 0.1, binary=False)


def test_a_missing_map_is_named(tmp_path: Path) -> None:
    with pytest.raises(pdoik.LoadError, match=r"gone.bt: cannot be read: No such file"):
        pdoik.Shape.octomap("it", tmp_path / "gone.bt")
    with pytest.raises(pdoik.LoadError, match=r"gone.bt: no such file"):
        pdoik.load_scene(tmp_path / "gone.bt")
    path = tmp_path / "scene.yaml"
    path.write_text("shapes: [{name: it, octomap: gone.bt}]")
    with pytest.raises(pdoik.LoadError, match=r"\(it\).octomap: map 'gone.bt': no such file"):
        pdoik.load_scene(path)
    path.write_text("shapes: [{name: it, octomap: {file: gone.bt, unknown: 3}}]")
    with pytest.raises(pdoik.LoadError, match=r"\(it\).octomap.unknown: expected true or false"):
        pdoik.load_scene(path)
