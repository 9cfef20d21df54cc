"""Laws of the occupancy tool: hulls hold the geometry, reach known optima, survive a file."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pdoik import LoadError, Occupancy, occupancy_fit
from pdoik.occupancy_fit import (  # inside: its parts are tested one by one
    OccupancyFit,
    clip,
    half_sum,
    smallest_shape,
    split,
    union_volume,
)

SEED = 20240917
fit_occupancy = partial(occupancy_fit.fit_occupancy, capsules=False)
Array = NDArray[np.float64]


def collision(geometry: str, xyz: str = "0 0 0", rpy: str = "0 0 0") -> str:
    return (
        f'<collision><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{geometry}</geometry></collision>'
    )


def one_link(*collisions: str) -> str:
    return f'<robot name="r"><link name="a">{"".join(collisions)}</link></robot>'


def two_joints(*collisions: str) -> str:
    """Link b carries the collisions; its own joint is at its origin, link c's joint 0.4 m up."""
    return f"""
    <robot name="r">
      <link name="a"/> <link name="b">{"".join(collisions)}</link> <link name="c"/>
      <joint name="ab" type="revolute"> <parent link="a"/> <child link="b"/>
        <origin xyz="0.1 0 0.2"/> </joint>
      <joint name="bc" type="revolute"> <parent link="b"/> <child link="c"/>
        <origin xyz="0 0 0.4"/> </joint>
    </robot>"""


def l_shaped_link() -> str:
    return one_link(
        collision('<box size="0.1 0.1 0.6"/>', xyz="0 0 0.3"),
        collision('<box size="0.6 0.1 0.1"/>', xyz="0.25 0 0.65"),
    )


def clearance(fit: OccupancyFit, points: Array) -> Array:
    """How far each point is outside all hulls of the only link; negative inside, (N,) [m]."""
    outside = [
        half_sum(points, np.array(h.focus_a), np.array(h.focus_b)) - h.semi_major
        for h in fit.spheroids
    ]
    outside += [np.linalg.norm(points - np.array(h.center), axis=1) - h.radius for h in fit.spheres]
    return np.min(outside, axis=0)


def random_primitive(rng: np.random.Generator) -> tuple[str, Array]:
    """A random collision element and points that fill the true shape, corners and rims included."""
    kind = rng.choice(["box", "cylinder", "sphere"])
    size = rng.uniform(0.02, 0.4, 3)
    u = rng.uniform(-1, 1, (4000, 3))
    u[:1000] = np.sign(u[:1000])
    circle = u[:, :2] / np.maximum(np.linalg.norm(u[:, :2], axis=1, keepdims=True), 1e-9)
    if kind == "box":
        geometry, points = f'<box size="{size[0]} {size[1]} {size[2]}"/>', u * size / 2
    elif kind == "cylinder":
        geometry = f'<cylinder radius="{size[0]}" length="{size[1]}"/>'
        points = np.column_stack([size[0] * circle, size[1] / 2 * u[:, 2]])
    else:
        geometry = f'<sphere radius="{size[0]}"/>'
        points = size[0] * u / np.linalg.norm(u, axis=1, keepdims=True)
    xyz, rpy = rng.uniform(-0.3, 0.3, 3), rng.uniform(-3, 3, 3)
    T = trimesh.transformations.euler_matrix(*rpy, "sxyz")
    element = collision(geometry, " ".join(map(repr, xyz.tolist())), " ".join(map(str, rpy)))
    return element, points @ T[:3, :3].T + xyz


@pytest.fixture(scope="module")
def bent() -> OccupancyFit:
    """The L-shaped link, split until its hulls are within 1.6 times its convex hull."""
    return fit_occupancy(l_shaped_link(), max_volume_factor=1.6)


@pytest.mark.parametrize("seed", range(SEED, SEED + 8))
def test_one_hull_holds_every_point_of_a_random_primitive(seed: int) -> None:
    element, points = random_primitive(np.random.default_rng(seed))
    assert clearance(fit_occupancy(one_link(element), max_parts=1), points).max() < 0


@pytest.mark.parametrize("seed", [SEED, SEED + 1])
def test_two_hulls_hold_every_point_of_random_primitives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    elements, points = zip(*[random_primitive(rng) for _ in range(2)], strict=True)
    fit = fit_occupancy(one_link(*elements), max_volume_factor=1.0, max_parts=2)
    assert len(fit.report.hulls) == 2
    assert clearance(fit, np.vstack(points)).max() < 0


def test_hulls_hold_surface_and_inside_of_a_ring(tmp_path: Path) -> None:
    rng = np.random.default_rng(SEED)
    ring = trimesh.creation.torus(0.2, 0.05, major_sections=16, minor_sections=8)
    ring.export(tmp_path / "ring.stl")
    urdf = one_link(collision('<mesh filename="ring.stl"/>'))
    fit = fit_occupancy(urdf, packages=[tmp_path], max_volume_factor=1.0, max_parts=3)
    assert fit.report.links[0].n_hulls > 1

    surface, _ = trimesh.sample.sample_surface(ring, 8000, seed=SEED)
    core = surface * [1, 1, 0]
    core *= 0.2 / np.linalg.norm(core, axis=1, keepdims=True)
    inside = core + rng.uniform(0, 1, (8000, 1)) * (surface - core)
    assert (
        clearance(fit, np.vstack([surface, inside, ring.vertices])).max() < 1e-7
    )  # STL is float32


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_meshes_are_found_scaled_and_turned(tmp_path: Path, suffix: str) -> None:
    (tmp_path / "arm").mkdir()
    trimesh.creation.box((0.1, 0.2, 0.5)).export(tmp_path / "arm" / f"box.{suffix}")
    place = {"xyz": "0.1 0.2 0.3", "rpy": "0.1 0.2 0.3"}
    mesh = f'<mesh filename="package://arm/box.{suffix}" scale="1 -2 0.5"/>'
    box = '<box size="0.1 0.4 0.25"/>'
    (row,) = fit_occupancy(one_link(collision(mesh, **place)), [tmp_path], 100).report.hulls
    (same,) = fit_occupancy(one_link(collision(box, **place)), (), 100).report.hulls
    assert row.hull_volume == pytest.approx(same.hull_volume, rel=1e-6)
    assert row.geometry_volume == pytest.approx(0.01, rel=1e-6)

    beside = tmp_path / "arm" / "arm.urdf"
    beside.write_text(one_link(collision(f'<mesh filename="box.{suffix}"/>')), encoding="utf-8")
    assert fit_occupancy(beside, (), 100).report.links[0].geometry_volume == pytest.approx(0.01)


@pytest.mark.parametrize("seed", range(SEED, SEED + 4))
def test_joint_to_joint_spheroid_is_the_brute_force_maximum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, xyz = rng.uniform(0.05, 0.4, 3), rng.uniform(-0.2, 0.2, 3)
    urdf = two_joints(
        collision(f'<box size="{size[0]} {size[1]} {size[2]}"/>', xyz=" ".join(map(str, xyz)))
    )
    (hull,) = fit_occupancy(urdf, paper=True).spheroids
    assert (hull.link_a, hull.link_b) == ("b", "c")
    assert hull.focus_a == hull.focus_b == (0.0, 0.0, 0.0)  # each its own link's joint origin

    points = xyz + rng.uniform(-0.5, 0.5, (20_000, 3)) * size
    points[:2000] = xyz + np.sign(points[:2000] - xyz) * size / 2  # corners
    brute = half_sum(points, np.zeros(3), np.array([0, 0, 0.4])).max()
    assert hull.semi_major == pytest.approx(brute + 1e-6, abs=2e-9)


def test_joint_spheres_of_the_paper_add_no_volume() -> None:
    fit = fit_occupancy(two_joints(collision('<box size="0.2 0.2 0.6"/>')), paper=True)
    (hull,) = fit.spheroids
    assert {sphere.link for sphere in fit.spheres} == {"b", "c"}
    focus = {"b": np.zeros(3), "c": np.array([0, 0, 0.4])}
    directions = np.random.default_rng(SEED).normal(size=(5000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for sphere in fit.spheres:
        rim = focus[sphere.link] + sphere.radius * directions
        sums = half_sum(rim, focus["b"], focus["c"])
        assert sums.max() < hull.semi_major + 1e-8
        assert sums.max() > hull.semi_major - 1e-3  # and is the largest such ball


def test_joint_to_joint_spheroid_is_kept_where_it_is_tight_enough() -> None:
    urdf = two_joints(collision('<cylinder radius="0.06" length="0.5"/>', xyz="0 0 0.2"))
    assert [hull.link_b for hull in fit_occupancy(urdf, max_volume_factor=7).spheroids] == ["c"]
    assert "c" not in {hull.link_b for hull in fit_occupancy(urdf, max_volume_factor=6).spheroids}


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), through_vertex=st.booleans())
def test_clipped_halves_are_the_whole_surface(seed: int, through_vertex: bool) -> None:
    rng = np.random.default_rng(seed)
    triangles = rng.normal(size=(30, 3, 3))
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    offset = float(triangles[0, 0] @ normal) if through_vertex else float(rng.normal())
    upper, lower = clip(triangles, normal, offset), clip(triangles, -normal, -offset)

    def area(t: Array) -> float:
        return float(np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1).sum())

    assert area(upper) + area(lower) == pytest.approx(area(triangles), rel=1e-12)
    assert (upper @ normal).min(initial=offset) >= offset - 1e-12
    assert (lower @ normal).max(initial=offset) <= offset + 1e-12


def test_a_face_in_the_cutting_plane_belongs_to_both_halves() -> None:
    face = np.array([[[0.0, 0, 1], [1, 0, 1], [0, 1, 1]]])
    for sign in (1, -1):
        np.testing.assert_array_equal(clip(face, np.array([0, 0, sign]), sign), face)


def circle(radius: float, height: float) -> Array:
    angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    return np.column_stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.full_like(angle, height)]
    )


def test_smallest_hulls_reach_known_optima() -> None:
    cube = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T * 0.1
    ball = smallest_shape(cube)
    assert ball.is_ball
    assert ball.volume / 0.2**3 == pytest.approx(np.sqrt(3) * np.pi / 2, rel=1e-4)

    rims = (
        np.vstack([circle(0.05, -0.2), circle(0.05, 0.2)])
        @ np.linalg.qr(np.random.default_rng(SEED).normal(size=(3, 3)))[0]
    )
    spheroid = smallest_shape(rims + np.array([0.3, -0.2, 0.1]))
    assert not spheroid.is_ball
    assert spheroid.volume / (np.pi * 0.05**2 * 0.4) == pytest.approx(np.sqrt(3), rel=1e-3)


def test_union_volume_counts_overlap_once() -> None:
    ball = smallest_shape(circle(0.1, 0.0))
    assert union_volume([ball, ball]) == pytest.approx(4 / 3 * np.pi * 0.1**3, rel=0.01)


def test_each_further_hull_reduces_the_covered_volume() -> None:
    volumes = [
        fit_occupancy(l_shaped_link(), max_volume_factor=1, max_parts=n).report.links[0]
        for n in (1, 2, 3)
    ]
    assert [row.n_hulls for row in volumes[:2]] == [1, 2]
    assert volumes[1].covered_volume < 0.5 * volumes[0].covered_volume
    assert volumes[2].covered_volume < volumes[1].covered_volume


def test_splitting_stops_within_the_factor_and_the_budget(bent: OccupancyFit) -> None:
    assert bent.report.factor <= 1.6
    assert len(bent.spheres) + len(bent.spheroids) == len(bent.report.hulls) <= 3
    tight = fit_occupancy(l_shaped_link(), max_volume_factor=1, max_parts=3, max_hulls=2)
    assert len(tight.report.hulls) == 2


def test_splitting_ends_where_refinement_pushes_the_plane_off_the_part(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(split, "_refine", lambda _, plane: plane + np.eye(4)[3])
    fit = fit_occupancy(one_link(collision('<box size="0.2 0.2 0.2"/>')), (), 1, max_parts=3)
    assert clearance(fit, np.array([[0.1, 0.1, 0.1], [0, 0, 0], [-0.1, 0.1, 0.1]])).max() < 0


def test_every_cut_leaves_two_parts_or_none() -> None:
    box = trimesh.creation.box((0.1, 0.2, 0.3)).triangles
    parts = split.cover_stages(np.asarray(box), 1.0, 2)[-1]
    for part in parts:
        for piece in split._split(part):
            assert len(piece.triangles)
    point = np.zeros((1, 3, 3))
    assert split._split(split.Part(point, smallest_shape(point[0]))) == []


def test_a_round_part_is_held_by_a_sphere() -> None:
    fit = fit_occupancy(one_link(collision('<sphere radius="0.1"/>', xyz="0.2 0 0")))
    (sphere,), () = fit.spheres, fit.spheroids
    np.testing.assert_allclose(sphere.center, [0.2, 0, 0], atol=1e-4)
    assert 0.1 < sphere.radius < 0.102
    assert fit.report.hulls[0].kind == "sphere"
    assert fit.report.factor < 1.05


def test_report_adds_up(bent: OccupancyFit) -> None:
    report = bent.report
    for row in report.hulls:
        assert row.empty_volume == pytest.approx(row.hull_volume - row.geometry_volume)
        assert row.factor >= 1
    (link,) = report.links
    largest = max(row.hull_volume for row in report.hulls)
    assert largest < link.covered_volume <= 1.01 * sum(row.hull_volume for row in report.hulls)
    assert f"{link.factor:.2f}" in str(report)


def test_links_without_collision_geometry_are_skipped_and_listed() -> None:
    fit = fit_occupancy(two_joints(collision('<box size="0.1 0.1 0.1"/>')), (), 1000)
    assert fit.report.skipped == ("a", "c")
    assert "a " in str(fit.report)


def test_a_chain_can_be_chosen() -> None:
    urdf = two_joints(collision('<box size="0.1 0.1 0.1"/>'))

    def skipped(base_link: str | None, tip_link: str | None) -> tuple[str, ...]:
        return fit_occupancy(urdf, (), 1000, base_link, tip_link).report.skipped

    assert skipped("b", "b") == ()
    assert skipped("b", None) == ("c",)
    assert skipped(None, "b") == ("a",)


def test_links_beside_the_chain_are_named(bent: OccupancyFit) -> None:
    box = collision('<box size="0.1 0.1 0.1"/>')
    finger = f"""<link name="finger">{box}</link>
      <joint name="bf" type="fixed"> <parent link="b"/> <child link="finger"/> </joint></robot>"""
    urdf = two_joints(box).replace("</robot>", finger)
    fit = fit_occupancy(urdf, (), 1000, None, "c")
    assert fit.report.left_out == ("finger",)
    assert "finger " in str(fit.report)
    assert fit_occupancy(urdf, (), 1000).report.left_out == bent.report.left_out == ()


def test_the_same_input_gives_the_same_file(bent: OccupancyFit) -> None:
    assert fit_occupancy(l_shaped_link(), max_volume_factor=1.6).to_yaml() == bent.to_yaml()


def assert_same_hulls(data: dict[str, list[dict[str, object]]], fit: OccupancyFit) -> None:
    spheres = [(h["link"], tuple(h["center"]), h["radius"]) for h in data["spheres"]]  # type: ignore[arg-type]
    keys = ("link_a", "focus_a", "link_b", "focus_b", "semi_major")
    spheroids = [
        tuple(tuple(h[k]) if k.startswith("focus") else h[k] for k in keys)  # type: ignore[arg-type]
        for h in data["spheroids"]
    ]
    assert spheres == [tuple(hull) for hull in fit.spheres]
    assert spheroids == [tuple(hull) for hull in fit.spheroids]


def test_yaml_reads_back_to_the_same_numbers(tmp_path: Path, bent: OccupancyFit) -> None:
    path = tmp_path / "r.occupancy.yaml"
    path.write_text("old", encoding="utf-8")
    bent.write(path, comment="made by a test\n\nlicence: none")
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# made by a test\n#\n# licence: none\n")
    assert_same_hulls(yaml.safe_load(text), bent)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]  # nothing left behind


@pytest.mark.parametrize("name", ["on", "a: b #1", "7", "it's", 'say "x"', "Ärm"])
def test_odd_link_names_and_tiny_numbers_survive_the_file(name: str) -> None:
    ball = one_link(collision('<sphere radius="0.1"/>'))
    named = fit_occupancy(ball).moved({"a": (name, np.eye(4) + np.eye(4, k=3) * 2e-5)})
    for fit in (named, fit_occupancy(ball, paper=True)):
        assert_same_hulls(yaml.safe_load(fit.to_yaml()), fit)
        occupancy = Occupancy.load(fit.to_yaml())
        assert occupancy == Occupancy(spheres=fit.spheres, spheroids=fit.spheroids)


def test_a_failed_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fit = fit_occupancy(one_link(collision('<sphere radius="0.1"/>')))
    path = tmp_path / "r.occupancy.yaml"
    path.write_text("old", encoding="utf-8")

    def full_disk(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(Path, "replace", full_disk)
    with pytest.raises(OSError, match="no space"):
        fit.write(path)
    assert path.read_text(encoding="utf-8") == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_moved_hulls_hold_the_moved_geometry() -> None:
    rng = np.random.default_rng(SEED)
    element, points = random_primitive(rng)
    fit = fit_occupancy(one_link(element), max_volume_factor=1.0, max_parts=2)
    T = trimesh.transformations.euler_matrix(0.3, -1.0, 2.0, "sxyz")
    T[:3, 3] = [0.1, 0.2, -0.3]
    moved = fit.moved({"a": ("other", T)})
    assert {hull.link_a for hull in moved.spheroids} | {h.link for h in moved.spheres} == {"other"}
    np.testing.assert_allclose(
        clearance(moved, points @ T[:3, :3].T + T[:3, 3]), clearance(fit, points), atol=1e-8
    )
    with pytest.raises(ValueError, match="'a'"):
        fit.moved({})


@pytest.mark.parametrize(
    ("urdf", "message"),
    [
        ("<robot", "cannot read robot description"),
        ("no_such_file.urdf", "no_such_file.urdf"),
        ('<robot name="r"><link/></robot>', "'name'"),
        ('<robot name="r"><link name="a"/></robot>', "none of the links has collision geometry"),
        (one_link("<collision/>"), "'a' has a collision element without geometry"),
        (one_link(collision('<cone radius="1"/>')), "unknown collision shape <cone>"),
        (one_link(collision('<box size="1 1"/>')), "size='1 1', expected 3 positive numbers"),
        (one_link(collision('<box size="1 1 -1"/>')), "size='1 1 -1'"),
        (one_link(collision('<box size="1 1 x"/>')), "size='1 1 x'"),
        (one_link(collision('<sphere radius="nan"/>')), "radius='nan'"),
        (one_link(collision('<box size="1 1 1"/>', xyz="0 0")), "xyz='0 0', expected 3 numbers"),
        (one_link(collision("<mesh/>")), "'filename'"),
    ],
)
def test_bad_descriptions_are_refused_by_name(urdf: str, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        fit_occupancy(urdf)


def test_a_missing_mesh_names_the_file_and_where_it_was_sought(tmp_path: Path) -> None:
    urdf = one_link(collision('<mesh filename="package://arm/link.stl"/>'))
    with pytest.raises(LoadError, match=r"package://arm/link\.stl") as caught:
        fit_occupancy(urdf, packages=[tmp_path])
    assert str(tmp_path) in str(caught.value)


def test_an_unreadable_mesh_is_named(tmp_path: Path) -> None:
    (tmp_path / "broken.stl").write_bytes(b"solid nothing\nendsolid nothing\n")
    urdf = one_link(collision('<mesh filename="broken.stl"/>'))
    with pytest.raises(LoadError, match=r"broken\.stl"):
        fit_occupancy(urdf, packages=[tmp_path])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"max_volume_factor": 0.9}, "max_volume_factor must be at least 1, got 0.9"),
        ({"max_volume_factor": float("nan")}, "max_volume_factor"),
        ({"max_parts": 0}, "max_parts"),
        ({"max_hulls": 0}, "max_hulls is 0, but 1 links"),
        ({"base_link": "z"}, "base_link 'z'"),
        ({"tip_link": "z"}, "tip_link 'z'"),
        ({"base_link": "c", "tip_link": "b"}, "'b' does not hang on base_link 'c'"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fit_occupancy(two_joints(collision('<box size="1 1 1"/>')), **arguments)  # type: ignore[arg-type]
