"""Height fields as closed meshes, against MuJoCo's own and trimesh."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import trimesh

import pdoik

RNG = np.random.default_rng(8)


def mesh_of(shape: pdoik.Shape) -> trimesh.Trimesh:
    return trimesh.Trimesh(shape.vertices, shape.triangles, process=False)


@pytest.mark.parametrize(("rows", "columns"), [(2, 2), (2, 9), (7, 5)])
def test_the_ground_is_closed_and_as_large_as_its_cells(rows: int, columns: int) -> None:
    heights = RNG.uniform(-0.3, 0.5, (rows, columns))
    mesh = mesh_of(pdoik.Shape.height_field("ground", heights, (0.2, 0.5), bottom=-1.0))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    a, b, c, d = heights[:-1, :-1], heights[1:, :-1], heights[1:, 1:], heights[:-1, 1:]
    mean = ((a + b + c) / 6 + (a + c + d) / 6).sum() * 0.2 * 0.5  # each half of a cell
    assert mesh.volume == pytest.approx(mean + 0.1 * (rows - 1) * (columns - 1), rel=1e-12)
    assert mesh.bounds.tolist()[0] == [0, 0, -1]
    np.testing.assert_allclose(mesh.bounds[1][:2], (0.2 * (rows - 1), 0.5 * (columns - 1)))


def heights_under(model: mujoco.MjModel, places: np.ndarray) -> np.ndarray:
    """Where rays from 3 m above stop, by MuJoCo."""
    state = mujoco.MjData(model)
    mujoco.mj_forward(model, state)
    down, geom = np.array([0, 0, -1.0]), np.zeros(1, np.int32)
    return np.array(
        [
            3.0 - mujoco.mj_ray(model, state, np.array([*xy, 3.0]), down, None, 1, -1, geom)
            for xy in places
        ]
    )


def test_rays_fall_as_far_as_on_mujocos_own_height_field() -> None:
    heights = RNG.uniform(0.0, 1.0, (9, 6))
    theirs = mujoco.MjModel.from_xml_string(
        '<mujoco><asset><hfield name="h" nrow="6" ncol="9" size="0.8 1 1 0.2"/></asset>'
        '<worldbody><geom type="hfield" hfield="h" pos="0.8 1 0"/></worldbody></mujoco>'
    )
    theirs.hfield_data[:] = heights.T.ravel()  # its rows go along y
    shape = pdoik.Shape.height_field("ground", heights, (0.2, 0.4), bottom=-0.2)
    vertices, faces = (
        " ".join(map(repr, each.ravel().tolist())) for each in (shape.vertices, shape.triangles)
    )
    ours = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="h" vertex="{vertices}" face="{faces}"/></asset>'
        '<worldbody><geom type="mesh" mesh="h"/></worldbody></mujoco>'
    )
    places = RNG.uniform((0.01, 0.01), (1.59, 1.99), (300, 2))
    found = heights_under(theirs, places)
    assert np.ptp(found) > 0.5
    np.testing.assert_allclose(heights_under(ours, places), found, atol=1e-6)


def test_the_bottom_is_far_below_unless_told() -> None:
    shape = pdoik.Shape.height_field("ground", np.zeros((11, 3)), 0.1, np.eye(4))
    assert shape.vertices[:, 2].min() == pytest.approx(-1.0)


def test_a_solver_stays_above_the_ground() -> None:
    robot = pdoik.Robot.builtin("panda")
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    T = np.eye(4)
    T[:3, 3] = 0.2, -1.0, 0.0
    flat = pdoik.Shape.height_field("ground", np.full((11, 21), 0.3), 0.1, T)
    box = np.eye(4)
    box[:3, 3] = 0.7, 0.0, -0.7
    as_box = pdoik.Shape.box("ground", (1.0, 2.0, 2.0), box)
    solved = 0
    for _ in range(30):
        target = robot.fk(RNG.uniform(robot.lower, robot.upper))
        result = solver.solve(target, obstacles=[flat])
        if result.success:
            solved += 1
            assert solver.judge(target, result.q, obstacles=[as_box]).success
        elif target[0, 3] > 0.3 and target[2, 3] > 0.1 and target[2, 3] < 0.25:
            assert not solver.solve(target, obstacles=[as_box]).success
    assert solved >= 10


@pytest.mark.parametrize(
    ("heights", "cell", "bottom", "says"),
    [
        ([[1.0, 2.0]], 0.1, None, r"heights have shape \(1, 2\), expected two rows"),
        ([1.0, 2.0], 0.1, None, r"heights have shape \(2,\)"),
        ([[0, 1], [np.nan, 0]], 0.1, None, r"heights\[1, 0\] is nan: fill what was not seen"),
        ([[0, 1], [1, 0]], 0.0, None, r"cell is 0.0, expected one or two distances above 0"),
        ([[0, 1], [1, 0]], (0.1, 0.1, 0.1), None, r"cell is \(0.1, 0.1, 0.1\)"),
        ([[0, 1], [1, 0]], 0.1, 0.0, r"bottom is 0.0, expected one below the lowest height, 0"),
        ([[0, 1], [1, 0]], 0.1, np.nan, r"bottom is nan"),
    ],
)
def test_what_is_no_ground_is_refused(
    heights: object, cell: object, bottom: float | None, says: str
) -> None:
    with pytest.raises(ValueError, match=f"shape 'ground': {says}"):
        pdoik.Shape.height_field("ground", heights, cell, bottom=bottom)
