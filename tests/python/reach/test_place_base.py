"""Where a base or a part should stand, checked by Pinocchio from the best place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pdoik
from command_line import misuse, run
from conftest import ROBOTS
from pdoik.base_places import STATUSES, places_of, transform_of
from references import PinocchioRobot

ROBOT = pdoik.Robot.builtin("ur10")
REGION = {"x": (-1.2, 1.2, 0.6), "y": (-0.6, 0.6, 0.6), "yaw": (0.0, 1.5, 1.5)}


# So that no deadline makes answers differ.
PATIENT: dict[str, Any] = {"max_time": 30.0, "options": pdoik.Options(max_time=5.0)}


def seam(count: int = 30, x: float = 0.4) -> np.ndarray:
    """A straight one with the tool down, (N, 4, 4)."""
    T = np.tile(np.diag([1.0, -1.0, -1.0, 1.0]), (count, 1, 1))
    T[:, :3, 3] = np.linspace([x, -0.25, 0.3], [x, 0.25, 0.3], count)
    return T


def moved(T: np.ndarray, xyz: Any) -> np.ndarray:
    M = np.eye(4)
    M[:3, 3] = xyz
    return M @ T


def post(x: float = 0.4, y: float = 0.6) -> pdoik.Shape:
    return pdoik.Shape.box("post", (0.2, 0.2, 1.2), moved(np.eye(4), [x, y, 0.6]))


def test_the_best_place_lets_the_path_be_followed_in_the_world() -> None:
    found = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, threads=1, **PATIENT)
    assert len(found) == 5 * 3 * 2
    assert found.done.all()
    assert 0 < found.whole.sum() < len(found)
    best = found.best
    assert best is not None
    assert best.success
    assert best.score == found.score.max()
    T_base_world = np.linalg.inv(best.T)
    there = [post().moved(T_base_world @ post().T_base_shape)]
    solver = pdoik.Solver(ROBOT, PATIENT["options"])
    result = solver.solve_path(T_base_world @ seam(), there)
    assert result.success
    assert np.isclose(result.clearance, best.clearance)
    assert np.isclose(result.length, best.length)
    room = np.minimum(result.q - ROBOT.lower, ROBOT.upper - result.q).min()
    assert np.isclose(room, best.limits)
    pinocchio = PinocchioRobot.from_xml((ROBOTS / "ur10.urdf").read_text())
    for at, q in zip(result.at, result.q, strict=True):
        if at != round(at):
            continue
        pinocchio.set(dict(zip(ROBOT.joint_names, q.tolist(), strict=True)))
        T_world_tip = best.T @ pinocchio.pose(ROBOT.base_link, ROBOT.tip_links[0])
        assert np.abs(T_world_tip - seam()[round(at)]).max() < 2e-4


def test_a_place_is_whole_exactly_where_a_path_asked_alone_is() -> None:
    found = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, every=1, **PATIENT)
    solver = pdoik.Solver(ROBOT, PATIENT["options"])
    for k, place in enumerate(found.places):
        T = np.linalg.inv(transform_of(place))
        shape = post().moved(T @ post().T_base_shape)
        alone = solver.solve_path(T @ seam(), [shape], max_time=30.0, reconfigure=False)
        assert alone.success == found.whole[k]
        if not found.whole[k]:
            assert np.isnan(found.figures[k, 2:]).all()
            assert found.score[k] < 0.0


def test_a_base_beneath_the_post_or_too_far_is_told_apart_from_good_ones() -> None:
    region = [[0.4, 0.6, 0.0, 0.0], [-5.0, 0.0, 0.0, 0.0], [-0.3, 0.0, 0.0, 0.0]]
    found = pdoik.place_base(ROBOT, seam(), [post()], region=region)
    assert [STATUSES[k] for k in found.statuses] == ["unreached", "unreached", "whole"]
    assert found.order[0] == 2
    assert found[1].reached == 0.0
    assert found[2].reached == found[2].followed == 1.0


def test_the_part_may_move_instead_and_what_belongs_to_it_with_it() -> None:
    part = pdoik.Shape.box("part", (0.3, 0.5, 0.05), moved(np.eye(4), [0.0, 0.0, -0.03]))
    path = moved(seam(20, 0.0), [0.0, 0.0, -0.25])
    region = {"x": (0.3, 1.5, 0.3), "z": 0.2, "yaw": (-1.5, 1.5, 1.5)}
    found = pdoik.place_base(
        ROBOT, path, [post()], region=region, move="part", part=[part], **PATIENT
    )
    assert found.move == "part"
    best = found.best
    assert best is not None
    there = [post(), part.moved(best.T @ part.T_base_shape)]
    result = pdoik.Solver(ROBOT, PATIENT["options"]).solve_path(best.T @ path, there)
    assert result.success
    assert np.isclose(result.clearance, best.clearance)
    # The same arrangement, told as a base that moves.
    again = pdoik.place_base(
        ROBOT, best.T @ path, there, region=[[0.0, 0.0, 0.0, 0.0]], move="base", **PATIENT
    )
    assert np.isclose(again[0].score, best.score)


def test_points_move_like_shapes_and_several_paths_all_count() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform([0.3, 0.5, 0.0], [0.5, 0.7, 1.2], (300, 3))
    other = seam(20, 0.9)
    region = {"x": (-0.6, 0.6, 0.3), "yaw": 0.7}
    one = pdoik.place_base(ROBOT, seam(), points, region=region, **PATIENT)
    radii = np.column_stack([points, np.full(300, 0.01)])
    swollen = pdoik.place_base(ROBOT, seam(), pdoik.Cloud(radii), region=region, **PATIENT)
    both = pdoik.place_base(ROBOT, [seam(), other], points, region=region, **PATIENT)
    second = pdoik.place_base(ROBOT, other, points, region=region, **PATIENT)
    assert np.array_equal(both.whole, one.whole & second.whole)
    common = both.whole
    assert common.any()
    least = np.minimum(one.figures[common, 3], second.figures[common, 3])
    assert np.allclose(both.figures[common, 3], least)
    fat = swollen.whole & one.whole
    assert (swollen.figures[fat, 3] < one.figures[fat, 3] + 1e-6).all()


def test_a_free_axis_and_goals_say_the_same() -> None:
    region = {"x": (-0.6, 0.0, 0.3)}
    free = pdoik.place_base(ROBOT, seam(), region=region, free="z", **PATIENT)
    goals = [pdoik.Goal(T, type="axis", axis="z") for T in seam()]
    told = pdoik.place_base(ROBOT, goals, region=region, **PATIENT)
    assert np.array_equal(free.statuses, told.statuses)
    assert np.allclose(free.figures, told.figures, equal_nan=True)
    corners = pdoik.place_base(ROBOT, seam(2), region=region, spacing=0.02)
    assert corners.whole.any()
    assert len(corners.ways[0]) == 26


def test_threads_and_chunks_change_nothing() -> None:
    one = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, threads=1, chunk=1, **PATIENT)
    two = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, threads=2, chunk=50, **PATIENT)
    assert np.array_equal(one.statuses, two.statuses)
    assert np.array_equal(one.figures, two.figures, equal_nan=True)


def test_what_was_interrupted_goes_on_from_its_file(tmp_path: Path) -> None:
    keep = tmp_path / "places.npz"
    whole = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, free="z", **PATIENT)

    class StopError(Exception):
        pass

    def stop(done: int) -> None:
        if done >= 9:
            raise StopError

    with pytest.raises(StopError):
        pdoik.place_base(
            ROBOT,
            seam(),
            [post()],
            region=REGION,
            free="z",
            **PATIENT,
            keep=keep,
            chunk=3,
            progress=stop,
        )
    part = pdoik.BasePlaces.load(keep)
    assert part.done.sum() == 9
    assert np.isneginf(part.score[~part.done]).all()
    counts: list[int] = []
    again = pdoik.place_base(
        ROBOT, seam(), [post()], region=REGION, free="z", **PATIENT, keep=keep, chunk=3,
        progress=counts.append,
    )  # fmt: skip
    assert counts[0] == 12
    assert counts[-1] == len(whole)
    assert np.array_equal(again.statuses, whole.statuses)
    assert np.allclose(again.figures, whole.figures, equal_nan=True)
    with pytest.raises(ValueError, match="another question"):
        pdoik.place_base(ROBOT, seam(), [post()], region=REGION, keep=keep)


def test_workers_share_the_work() -> None:
    distributed = pytest.importorskip("distributed")
    alone = pdoik.place_base(ROBOT, seam(), [post()], region=REGION, free="z", **PATIENT)
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        shared = pdoik.place_base(
            ROBOT,
            seam(),
            [post()],
            region=REGION,
            free="z",
            **PATIENT,
            client=client,
            threads=1,
            chunk=7,
        )
    assert np.array_equal(alone.statuses, shared.statuses)
    assert np.allclose(alone.figures, shared.figures, equal_nan=True)


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_a_file_gives_back_what_was_saved(tmp_path: Path, suffix: str) -> None:
    found = pdoik.place_base(ROBOT, seam(), region={"x": (-1.2, 0.6, 0.6)}, move="base")
    file = tmp_path / f"places{suffix}"
    found.save(file)
    again = pdoik.BasePlaces.load(file)
    assert np.array_equal(again.places, found.places)
    assert np.array_equal(again.statuses, found.statuses)
    assert np.array_equal(again.figures, found.figures, equal_nan=True)
    assert again.move == found.move
    whole = file.read_bytes()
    for content in (b"", b"nothing of the kind", whole[: len(whole) // 3]):
        file.write_bytes(content)
        with pytest.raises(pdoik.LoadError, match="places"):
            pdoik.BasePlaces.load(file)
    with pytest.raises(pdoik.LoadError):
        pdoik.BasePlaces.load(tmp_path / f"none{suffix}")
    with pytest.raises(ValueError, match=r"\.csv or \.npz"):
        found.save(tmp_path / "places.txt")


def test_a_map_is_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    found = pdoik.place_base(ROBOT, seam(), region=REGION)
    found.map(tmp_path / "map.png", title="seam")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    nowhere = pdoik.place_base(ROBOT, seam(), region=[[9.0, 0.0, 0.0, 0.0]])
    assert nowhere.best is None
    assert nowhere.map().axes
    with pytest.raises(ValueError, match=r"\.png"):
        found.map(tmp_path / "map.pdf")


def test_a_region_is_all_combinations_of_its_ranges_with_both_ends() -> None:
    places = places_of({"x": (0.0, 0.3, 0.1), "yaw": (-1.0, 1.0, 1.0), "z": 0.5})
    assert len(places) == 12
    assert np.array_equal(np.unique(places[:, 0]), [0.0, 0.1, 0.2, 0.3])
    assert np.array_equal(np.unique(places[:, 3]), [-1.0, 0.0, 1.0])
    assert set(places[:, 2]) == {0.5}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"region": {"u": 1.0}}, "has 'u'"),
        ({"region": {"x": (0.0, 1.0)}}, "for x"),
        ({"region": {"x": (1.0, 0.0, 0.1)}}, "from 1 to 0"),
        ({"region": {"x": (0.0, 1.0, 0.0)}}, "by 0 in x"),
        ({"region": {"x": float("nan")}}, "for x"),
        ({"region": np.zeros((0, 4))}, "region has shape"),
        ({"region": np.zeros((2, 3))}, "region has shape"),
        ({"every": 0}, "every"),
        ({"chunk": 0}, "chunk"),
        ({"move": "table"}, "move"),
        ({"paths": []}, "paths is empty"),
        ({"paths": np.eye(4)}, "shape"),
        ({"paths": seam()[:1]}, "station"),
        ({"paths": [pdoik.Goal.center_of_mass([-1, -1, -1], [1, 1, 1])] * 2}, "centre of mass"),
        ({"obstacles": np.zeros((3, 2))}, "obstacles has shape"),
        ({"max_time": -1.0}, "max_time"),
        ({"costs": {"speed": 1.0}}, "speed"),
        ({"keep": "places.csv"}, "keep"),
    ],
)
def test_misuse_is_told(changes: dict[str, Any], words: str) -> None:
    asked: dict[str, Any] = {"paths": seam(), "region": {"x": 0.0}, **changes}
    with pytest.raises(ValueError, match=words):
        pdoik.place_base(ROBOT, **asked)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    rows = [",".join(f"{value:.6f}" for value in T[:3, 3]) + ",1,0,0,0" for T in seam()]
    path = tmp_path / "seam.csv"
    path.write_text("\n".join(["x,y,z,qx,qy,qz,qw", *rows]) + "\n")
    return path


def test_the_command_prints_the_best_places_and_writes_all(tmp_path: Path, file: Path) -> None:
    pytest.importorskip("matplotlib")
    out, picture = tmp_path / "places.csv", tmp_path / "map.png"
    ranges = ("--x", "-0.9:0.9:0.3", "--y", "0", "--yaw", "-1.5:1.5:1.5")
    written = ("--out", out, "--picture", picture)
    outcome = run("place", file, "--robot", "ur10", *ranges, *written)
    assert outcome.exit_code == 0, outcome.output
    found = pdoik.BasePlaces.load(out)
    assert len(found) == 21
    assert f"whole from {found.whole.sum()} of 21 places" in outcome.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    kept = tmp_path / "places.npz"
    for _ in range(2):
        outcome = run("place", file, "--robot", "ur10", *ranges, "--out", kept)
        assert outcome.exit_code == 0
    assert np.array_equal(pdoik.BasePlaces.load(kept).statuses, found.statuses)
    nowhere = run("place", file, "--robot", "ur10", "--x", "9")
    assert nowhere.exit_code == 1
    assert "whole from 0 of 1 places" in nowhere.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--x", "a:b:c"), ("--x", "FROM:TO:STEP")),
        (("--x", "0:1"), ("--x", "FROM:TO:STEP")),
        (("--x", "1:0:0.1"), ("--x", "TO")),
        (("--out", "places.yaml"), ("--out", ".csv")),
        (("--every", "0"), ("--every",)),
    ],
)
def test_misuse_of_the_command_is_told(
    file: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    misuse(run("place", file, "--robot", "ur10", *arguments), *words)
