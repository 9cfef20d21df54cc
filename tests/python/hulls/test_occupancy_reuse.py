"""Links that need no fit: twins of others, and fits that are kept."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from pdoik import LoadError
from pdoik.occupancy_fit import (
    LinkNews,
    OccupancyFit,
    fit_occupancy,
    half_sum,
    load_geometry,
    motion_between,
    read_fit,
)
from test_occupancy_capsules import gap, on_surface

SEED = 20261129
Array = NDArray[np.float64]


def wedge() -> trimesh.Trimesh:
    """Without any symmetry, of two convex parts."""
    foot = trimesh.convex.convex_hull(
        np.array([[0, 0, 0], [0.12, 0, 0], [0, 0.07, 0], [0, 0, 0.05], [0.03, 0.05, 0.04]])
    )
    parameter_id = trimesh.creation.box((0.03, 0.02, 0.025)).apply_translation([0.08, 0.06, 0.05])
    return trimesh.util.concatenate([foot, parameter_id])


def motion(*, mirrored: bool) -> Array:
    T = trimesh.transformations.euler_matrix(0.4, -1.1, 2.3, "sxyz")
    if mirrored:
        T[:3, :3] = T[:3, :3] @ np.diag([1, -1, 1])
    T[:3, 3] = [0.2, -0.1, 0.4]
    return T


def shuffled(triangles: Array) -> Array:
    """In another order, with other first corners, turned inside out."""
    rng = np.random.default_rng(SEED)
    return np.roll(rng.permutation(triangles)[:, ::-1], 1, axis=1)


def urdf_of(folder: Path, *scales: str) -> str:
    """A link for each scale of one mesh, turned about by its place."""
    wedge().export(folder / "wedge.stl")
    links = [
        f'<link name="link{k}"><collision><origin xyz="{0.1 * k} 0 0" rpy="{k} 0.3 0"/><geometry>'
        f'<mesh filename="{folder}/wedge.stl" scale="{scale}"/></geometry></collision></link>'
        for k, scale in enumerate(scales)
    ]
    joints = [
        f'<joint name="joint{k}" type="fixed"><parent link="link{k - 1}"/><child link="link{k}"/>'
        "</joint>"
        for k in range(1, len(scales))
    ]
    return f'<robot name="r">{"".join(links + joints)}</robot>'


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_motion_is_found_whatever_the_order_of_triangles(mirrored: bool) -> None:
    first = np.asarray(wedge().triangles)
    T = motion(mirrored=mirrored)
    second = shuffled(first @ T[:3, :3].T + T[:3, 3])
    found = motion_between(first, second)
    assert found is not None
    np.testing.assert_allclose(found.R, T[:3, :3], atol=1e-9)
    np.testing.assert_allclose(found.t, T[:3, 3], atol=1e-9)
    assert found.mirrors == mirrored
    assert found.slack < 1e-9


def test_what_differs_by_a_corner_or_an_edge_is_no_twin() -> None:
    first = np.asarray(wedge().triangles)
    moved = first.copy()
    corner = moved[0, 0].copy()
    moved[(first == corner).all(axis=2)] += 1e-4
    assert motion_between(first, moved) is None
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    one = square[[[0, 1, 2], [0, 2, 3]]]
    bent = square + np.array([[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 0]])
    assert motion_between(one, bent[[[0, 1, 2], [0, 2, 3]]]) is None
    assert motion_between(bent[[[0, 1, 2], [0, 2, 3]]], bent[[[0, 1, 3], [1, 2, 3]]]) is None
    assert motion_between(one, one[:1]) is None


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("twins")


@pytest.fixture(scope="module")
def urdf(folder: Path) -> str:
    """A mesh, itself elsewhere, its mirror image, and one stretched."""
    return urdf_of(folder, "1 1 1", "1 1 1", "1 -1 1", "1 1 1.2")


@pytest.fixture(scope="module")
def told() -> list[LinkNews]:
    return []


@pytest.fixture(scope="module")
def fit(urdf: str, folder: Path, told: list[LinkNews]) -> OccupancyFit:
    return fit_occupancy(urdf, max_volume_factor=1.5, cache=folder, progress=told.append)


def test_each_kind_of_geometry_is_fitted_once(fit: OccupancyFit, told: list[LinkNews]) -> None:
    assert {news.link for news in told if news.state == "begun"} == {"link0", "link3"}
    assert {news.link for news in told if news.state == "fitted"} == {"link0", "link3"}
    assert [(n.link, n.like) for n in told if n.like] == [("link1", "link0"), ("link2", "link0")]
    assert [news.done for news in told if news.state != "begun"] == [1, 2, 3, 4]
    shares = [news.share for news in told]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert {hull.link for hull in fit.capsules} == {f"link{k}" for k in range(4)}


def test_twins_hulls_hold_the_twins_geometry(fit: OccupancyFit, urdf: str) -> None:
    for link in load_geometry(urdf):
        points = on_surface(link.triangles, 10_000)
        own = [tuple(hull)[1:4] for hull in fit.capsules if hull.link == link.name]
        assert gap(own, points).max() < 0
        wide = [half_sum(points, np.array(h.focus_a), np.array(h.focus_b)) - h.semi_major
                for h in fit.spheroids if h.link_a == link.name]  # fmt: skip
        wide += [np.linalg.norm(points - np.array(h.center), axis=1) - h.radius
                 for h in fit.spheres if h.link == link.name]  # fmt: skip
        assert np.min(wide, axis=0).max() < 0


def test_twins_pieces_are_closed_and_face_outwards(fit: OccupancyFit, urdf: str) -> None:
    for link in load_geometry(urdf):
        own = [piece for piece in fit.pieces if piece.link == link.name]
        assert len(own) == 2
        inside = np.zeros(3 * len(link.triangles), dtype=bool)
        for piece in own:
            mesh = trimesh.Trimesh(piece.vertices, piece.triangles, process=False)
            assert mesh.is_watertight
            assert mesh.volume > 0
            hull = ConvexHull(piece.vertices)
            over = hull.equations[:, :3] @ link.triangles.reshape(-1, 3).T + hull.equations[:, 3:]
            inside |= over.max(axis=0) < -0.9e-5
        assert inside.all()


def test_a_second_fit_takes_all_links_from_the_cache(
    fit: OccupancyFit, urdf: str, folder: Path
) -> None:
    told: list[LinkNews] = []
    again = fit_occupancy(urdf, max_volume_factor=1.5, cache=folder, progress=told.append)
    assert again == fit
    assert {news.state for news in told} == {"kept", "like"}


def test_a_mesh_or_an_argument_that_changed_is_fitted_anew(
    fit: OccupancyFit, urdf: str, folder: Path
) -> None:
    files = set(folder.glob("*.json"))
    assert len(files) == 2
    fit_occupancy(urdf, max_volume_factor=1.4, capsules=False, cache=folder)
    more = set(folder.glob("*.json")) - files
    assert more
    box = '<robot name="r"><link name="a"><collision><geometry><box size="{} 0.1 0.1"/></geometry>'
    box += "</collision></link></robot>"
    for size in ("0.2", "0.2000001"):
        fit_occupancy(box.format(size), capsules=False, cache=folder)
    assert len(set(folder.glob("*.json")) - files - more) == 2


@pytest.mark.parametrize("damage", ["cut", "digit", "nonsense", "empty"])
def test_a_damaged_file_is_no_fit(
    damage: str, fit: OccupancyFit, folder: Path, tmp_path: Path
) -> None:
    for file in folder.glob("*.json"):
        text = file.read_text()
        number = text.rindex("0.0")
        (tmp_path / file.name).write_text(
            {
                "cut": text[: len(text) // 2],
                "digit": text[: number + 2] + "1" + text[number + 3 :],
                "nonsense": json.dumps({"a": 1}),
                "empty": "",
            }[damage]
        )
    for file in folder.glob("*.json"):
        assert read_fit(tmp_path / file.name) is None
        assert read_fit(file) is not None


def test_an_interrupted_fit_goes_on_where_it_was(urdf: str, tmp_path: Path) -> None:
    class StoppedError(Exception):
        pass

    def stop(news: LinkNews) -> None:
        if news.state == "fitted":
            raise StoppedError

    with pytest.raises(StoppedError):
        fit_occupancy(urdf, capsules=False, max_volume_factor=1.2, cache=tmp_path, progress=stop)
    told: list[LinkNews] = []
    fit_occupancy(urdf, capsules=False, max_volume_factor=1.2, cache=tmp_path, progress=told.append)
    assert [news.state for news in told if news.state == "kept"] == ["kept"]
    assert not list(tmp_path.glob(".*"))


def test_the_cache_is_where_the_user_says(
    urdf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    box = '<robot name="r"><link name="a"><collision><geometry><box size="0.2 0.1 0.1"/></geometry>'
    box += "</collision></link></robot>"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.setenv("PDOIK_CACHE", "")
    fit_occupancy(box, capsules=False)
    assert not list(tmp_path.iterdir())
    monkeypatch.setenv("PDOIK_CACHE", str(tmp_path / "moved"))
    fit_occupancy(box, capsules=False)
    assert len(list((tmp_path / "moved" / "hulls").iterdir())) == 1
    monkeypatch.delenv("PDOIK_CACHE")
    fit_occupancy(box, capsules=False)
    assert len(list((tmp_path / "xdg" / "pdoik" / "hulls").iterdir())) == 1
    fit_occupancy(box, capsules=False, cache=False)
    (tmp_path / "file").write_text("")
    fit_occupancy(box, capsules=False, cache=tmp_path / "file")  # cannot be written to
    assert (tmp_path / "file").read_text() == ""


def test_processes_find_the_same_hulls_as_one(tmp_path: Path, urdf: str) -> None:
    """In a program of its own, as a user writes it."""
    (tmp_path / "arm.urdf").write_text(urdf)
    (tmp_path / "fit.py").write_text(
        "from pdoik.occupancy_fit import fit_occupancy\n"
        "if __name__ == '__main__':\n"
        "    arguments = dict(max_volume_factor=1.2, capsules=False, cache=False)\n"
        "    one, two = (fit_occupancy('arm.urdf', processes=n, **arguments) for n in (1, 2))\n"
        "    assert one.spheroids\n"
        "    assert one == two\n"
    )
    subprocess.run([sys.executable, "fit.py"], cwd=tmp_path, check=True, timeout=300)
    with pytest.raises(ValueError, match="processes must be at least 1, got 0"):
        fit_occupancy(urdf, processes=0)


def test_all_meshes_that_are_missing_are_named_at_once(tmp_path: Path) -> None:
    urdf = urdf_of(tmp_path, "1 1 1", "1 1 1", "1 1 1")
    for k, name in enumerate(("first.stl", "wedge.stl", "third.stl")):
        before, mark, after = urdf.partition(f'<link name="link{k}">')
        urdf = before + mark + after.replace("wedge.stl", name, 1)
    with pytest.raises(
        LoadError, match=r"2 meshes are missing: link 'link0': .*first.*link2.*third"
    ):
        load_geometry(urdf)


def test_a_mirrored_scale_mirrors_and_keeps_the_units_of_collada(tmp_path: Path) -> None:
    wedge().apply_scale(1000).export(tmp_path / "wedge.dae")
    text = (tmp_path / "wedge.dae").read_text()
    head, _, tail = text.partition("<asset>")
    (tmp_path / "wedge.dae").write_text(
        f'{head}<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>'
        + tail.partition("</asset>")[2]
    )
    urdf = (
        '<robot name="r"><link name="a"><collision><geometry>'
        f'<mesh filename="{tmp_path}/wedge.dae" scale="1 -1 1"/>'
        "</geometry></collision></link></robot>"
    )
    (link,) = load_geometry(urdf)
    bounds = wedge().bounds * [1, -1, 1]
    points = link.triangles.reshape(-1, 3)
    np.testing.assert_allclose(points.min(axis=0), bounds.min(axis=0), atol=1e-9)
    np.testing.assert_allclose(points.max(axis=0), bounds.max(axis=0), atol=1e-9)
    found = motion_between(np.asarray(wedge().triangles), link.triangles)
    assert found is not None
    np.testing.assert_allclose(found.R, np.diag([1, -1, 1]), atol=1e-6)
