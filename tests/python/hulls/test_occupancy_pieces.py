"""Convex pieces of links: what they hold, how far they stand out, and solves by them."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

import pdoik
from pdoik.occupancy_fit import TOLERANCE, Beyond, fit_occupancy, fit_pieces

FloatArray = NDArray[np.float64]

URDF = """<robot name="stick">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <link name="arm">
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.04 0.1"/></geometry></collision>
    <collision><origin xyz="0.4 0 0.1"/><geometry><box size="0.04 0.2 0.04"/></geometry></collision>
  </link>
</robot>"""


def _box(size: tuple[float, float, float], at: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(
        extents=size, transform=trimesh.transformations.translation_matrix(at)
    )


def test_each_connected_convex_part_is_a_piece_that_holds_it() -> None:
    meshes = [
        trimesh.creation.cylinder(radius=0.05, height=0.2, sections=40),
        trimesh.creation.icosphere(radius=0.06),
        _box((0.1, 0.2, 0.05), (0.2, 0.0, 0.1)),
    ]
    triangles = np.concatenate([mesh.triangles for mesh in meshes])
    pieces = fit_pieces("link", triangles)
    assert len(pieces) == len(meshes)
    hulls = [ConvexHull(piece.vertices) for piece in pieces]
    for mesh in meshes:
        held = [
            (hull.equations[:, :3] @ mesh.vertices.T + hull.equations[:, 3:]).max() < -0.9e-5
            for hull in hulls
        ]
        assert any(held)
    for piece, hull in zip(pieces, hulls, strict=True):
        own = trimesh.Trimesh(piece.vertices, piece.triangles)
        assert own.is_watertight
        assert own.volume == pytest.approx(hull.volume, rel=1e-6)
        assert 1e-5 <= piece.tolerance < 1e-3


_CHORD = 0.07 * (1 - np.cos(np.pi / 25))  # of the coarsest ring's hole [m]


def _ring(sections: int) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """A torus whose hole is 14 cm wide, and how far places are outside it, < 0 inside [m]."""
    mesh = trimesh.creation.torus(0.1, 0.03, major_sections=sections, minor_sections=sections)

    def outside(places: FloatArray) -> FloatArray:
        across = np.linalg.norm(places[:, :2], axis=1) - 0.1
        return np.hypot(across, places[:, 2]) - 0.03

    return np.asarray(mesh.triangles), outside


def _bracket() -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """An L of two plates 2 cm thick, closed, its inner corner sharp."""
    outline = np.array([[0.0, 0.0], [0.2, 0.0], [0.2, 0.02], [0.02, 0.02], [0.02, 0.1], [0.0, 0.1]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]])
    mesh = trimesh.creation.extrude_triangulation(outline, faces, 0.05)
    boxes = [([0, 0, 0], [0.2, 0.02, 0.05]), ([0, 0, 0], [0.02, 0.1, 0.05])]

    def outside(places: FloatArray) -> FloatArray:
        gaps = [np.maximum(np.array(low) - places, places - np.array(high)) for low, high in boxes]
        return np.min(
            [
                np.linalg.norm(np.maximum(gap, 0.0), axis=1) + np.minimum(gap.max(axis=1), 0.0)
                for gap in gaps
            ],
            axis=0,
        )

    return np.asarray(mesh.triangles), outside


@pytest.mark.parametrize(
    ("body", "most", "turned"),
    [(_ring(25), 60, True), (_bracket(), 25, False), (_bracket(), 25, True)],
)
def test_pieces_hold_a_concave_body_and_stand_out_no_farther_than_they_say(
    body: tuple[FloatArray, Callable[[FloatArray], FloatArray]], most: int, turned: bool
) -> None:
    triangles, outside = body
    if turned:  # the other way round: no normal can be trusted
        triangles = triangles[:, ::-1]
    pieces = fit_pieces("link", triangles)
    assert 2 <= len(pieces) <= most
    planes = [ConvexHull(piece.vertices).equations for piece in pieces]

    def beyond_pieces(places: FloatArray) -> FloatArray:
        return np.min([(places @ p[:, :3].T + p[:, 3]).max(axis=1) for p in planes], axis=0)

    mesh = trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    on, _ = trimesh.sample.sample_surface(mesh, 20_000, seed=1)
    assert beyond_pieces(np.asarray(on)).max() < 0.0
    low, high = mesh.bounds
    anywhere = np.random.default_rng(1).uniform(low, high, (40_000, 3))
    deep = anywhere[outside(anywhere) < -0.008]
    assert len(deep) > 500
    assert (beyond_pieces(deep) < 0.0).all()
    for piece in pieces:
        assert piece.tolerance <= TOLERANCE
        faces = trimesh.Trimesh(piece.vertices, piece.triangles)
        out = outside(np.asarray(trimesh.sample.sample_surface(faces, 4000, seed=2)[0]))
        assert out.max() < piece.tolerance + _CHORD + 2e-4  # what lies between the measured places


@pytest.mark.parametrize("turned", [False, True])
def test_how_far_places_are_beyond_a_body_is_exact(turned: bool) -> None:
    triangles, outside = _bracket()
    sharp = np.array([[0.3, 0.0, 0.0], [0.4, 0.001, 0.0], [0.4, -0.001, 0.0], [0.35, 0.0, 0.03]])
    spike = sharp[[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]]  # edges of two degrees
    hull = ConvexHull(sharp).equations
    beyond = Beyond(np.concatenate([triangles, spike])[:, ::-1] if turned else triangles)
    low, high = np.array([-0.02, -0.02, -0.02]), np.array([0.22, 0.12, 0.07])
    places = np.random.default_rng(3).uniform(low, high, (4000, 3))
    out = beyond(places)
    assert beyond.most(places) == out.max()
    np.testing.assert_array_equal(beyond(places, more_than=5e-3), np.where(out > 5e-3, out, 0.0))
    inner = places[out == 0.0]
    assert len(inner) > 300
    assert beyond.most(inner) == 0.0
    near = outside(places) < 0.05  # not nearer to the spike
    np.testing.assert_allclose(out[near], np.maximum(outside(places), 0.0)[near], atol=6e-5)
    if turned:
        about = np.random.default_rng(4).uniform(sharp.min(axis=0), sharp.max(axis=0), (4000, 3))
        inside = (about @ hull[:, :3].T + hull[:, 3]).max(axis=1) < 0.0
        assert inside.sum() > 200
        assert beyond(about[inside]).max() < 6e-5
        assert beyond(about[~inside]).min() >= 0.0
        far = (about @ hull[:, :3].T + hull[:, 3]).max(axis=1)
        assert (beyond(about) >= np.minimum(far, 1.0) - 6e-5).all()


def test_sheets_and_scraps_become_thin_pieces() -> None:
    flat = np.array([[[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]]])
    (piece,) = fit_pieces("link", flat)
    assert np.ptp(np.array(piece.vertices)[:, 2]) < 3e-4
    scrap = _ring(30)[0][:40]
    held = [ConvexHull(piece.vertices).equations for piece in fit_pieces("link", scrap)]
    corners = scrap.reshape(-1, 3)
    out = np.min([(corners @ p[:, :3].T + p[:, 3]).max(axis=1) for p in held], axis=0)
    assert out.max() < 0.0


def test_a_fit_keeps_them_and_solves_are_as_exact_as_the_boxes_they_are(tmp_path) -> None:
    fit = fit_occupancy(URDF)
    assert [(row.link, row.n_pieces) for row in fit.report.links] == [("base", 1), ("arm", 2)]
    file = tmp_path / "stick.yaml"
    fit.write(file)
    occupancy = pdoik.Occupancy.load(file)
    assert [piece[0] for piece in occupancy.pieces] == ["base", "arm", "arm"]
    assert pdoik.Occupancy.load(occupancy.to_yaml()) == occupancy
    robot = pdoik.Robot.from_urdf(URDF)
    robot.occupancy = occupancy
    wide = pdoik.Solver(robot, pdoik.Options(exact_contact=False))
    exact = pdoik.Solver(robot)
    rng = np.random.default_rng(0)
    freed = touching = 0
    for _ in range(2000):
        q = rng.uniform(-1, 1, 1)
        at = robot.fk(q, "arm")
        point = (
            at[:3, :3] @ (rng.uniform(-1, 1, 3) * [0.3, 0.15, 0.2] + [0.25, 0, 0.05]) + at[:3, 3]
        )
        local = np.linalg.inv(at) @ [*point, 1]
        truly = min(
            _to_box(local[:3] - [0.2, 0, 0], np.array([0.2, 0.02, 0.05])),
            _to_box(local[:3] - [0.4, 0, 0.1], np.array([0.02, 0.1, 0.02])),
            _to_box(point, np.full(3, 0.05)),
        )
        said = exact.judge(at, q, point[None]).clearance
        assert said < 0 or truly >= 0
        assert said >= 0 or truly < max(row[3] for row in occupancy.pieces)
        assert truly < 0 or said <= truly
        touching += truly < 0
        freed += truly >= 0 and wide.judge(at, q, point[None]).clearance < 0
    assert touching > 20
    assert freed > 5


def _to_box(point: np.ndarray, half: np.ndarray) -> float:
    over = np.abs(point) - half
    return float(np.linalg.norm(np.maximum(over, 0)) + min(over.max(), 0))
