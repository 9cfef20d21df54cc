"""Files that descriptions and scenes name: by package, path or URL, wherever they are asked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from pdoik._addresses import Places, with_paths
from pdoik.errors import LoadError
from pdoik.occupancy_fit import load_geometry
from pdoik.scenes import load_scene
from pdoik.view.visuals import load_visuals

VARIABLES = ("PDOIK_PACKAGE_PATH", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")


@pytest.fixture(autouse=True)
def nothing_set(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


def made(path: Path, text: str = "") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_a_package_is_where_it_is_told_to_be(tmp_path: Path) -> None:
    mesh = made(tmp_path / "my arm & co" / "meshes" / "a b.stl")
    address = "package://arm/meshes/a b.stl"
    named = Places.of({"arm": tmp_path / "my arm & co"})
    assert named.find(address) == mesh
    inside = made(tmp_path / "ws" / "arm" / "meshes" / "a b.stl")
    for told in ([tmp_path / "ws"], tmp_path / "ws", [tmp_path / "ws" / "arm"]):
        assert Places.of(told).find(address) == inside
    text = f'<robot><mesh scale="1 1 1" filename = "{address}"/></robot>'
    assert "my arm &amp; co/meshes/a b.stl" in with_paths(text, named)
    assert with_paths(with_paths(text, named), Places()) == with_paths(text, named)


@pytest.mark.parametrize("variable", VARIABLES)
def test_variables_of_ros_count(
    tmp_path: Path, variable: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = made(tmp_path / "install" / "share" / "arm" / "a.stl")
    monkeypatch.setenv(variable, f"{tmp_path / 'none'}:{tmp_path / 'install'}")
    assert Places.of().find("package://arm/a.stl") == mesh


def test_a_package_is_called_as_its_manifest_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clone = tmp_path / "src" / "vendor" / "Robot_ROS2_Description"
    made(clone / "package.xml", "<package><name> arm_description </name></package>")
    mesh = made(clone / "meshes" / "a.stl")
    urdf = made(clone / "urdf" / "arm.urdf")
    address = "package://arm_description/meshes/a.stl"
    assert Places.of((), urdf).find(address) == mesh
    assert Places.of([tmp_path / "src"]).find(address) == mesh
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    assert Places.of().find(address) == mesh


def test_paths_are_beside_the_file_and_others_by_their_last_parts(tmp_path: Path) -> None:
    urdf = made(tmp_path / "robot" / "arm.urdf")
    mesh = made(tmp_path / "robot" / "meshes" / "a b.stl")
    places = Places.of((), urdf)
    for address in (
        "meshes/a b.stl",
        "../robot/meshes/a b.stl",
        str(mesh),
        f"file://{mesh}",
        f"file://{str(mesh).replace(' ', '%20')}",
        "file:///home/other/work/meshes/a b.stl",
        "package://unknown/meshes/a b.stl",
        "model://unknown/meshes/a b.stl",
    ):
        assert places.find(address).resolve() == mesh, address
    assert Places.of().find(str(mesh)) == mesh  # of a text, too


def test_what_is_nowhere_is_said_with_how_to_tell_it(tmp_path: Path) -> None:
    urdf = made(tmp_path / "arm.urdf")
    with pytest.raises(LoadError, match=r"package 'arm' is nowhere.*packages=\{'arm': FOLDER\}"):
        Places.of((), urdf).find("package://arm/a.stl")
    (tmp_path / "wrong").mkdir()
    made(tmp_path / "a.stl")
    with pytest.raises(LoadError, match=r"wrong/a\.stl: no such file"):  # nor the one beside it
        Places.of({"arm": tmp_path / "wrong"}, urdf).find("package://arm/a.stl")
    with pytest.raises(LoadError, match=r"'arm' is said to be in .*none: no such folder"):
        Places.of({"arm": tmp_path / "none"})
    with pytest.raises(LoadError, match=r"said to be in .*none: no such folder"):
        Places.of([tmp_path / "none"])
    with pytest.raises(LoadError, match=rf"'b\.stl': no such file in {tmp_path}"):
        Places.of((), urdf).find("b.stl")
    with pytest.raises(LoadError, match="no such file"):
        Places.of((), urdf).find("a" * 5000)
    for address in ("package://", "package:///a", "package://..", "~nobody/b.stl", "", "\0"):
        with pytest.raises(LoadError):
            Places.of((), urdf).find(address)


def _geometry(folder: Path, address: str, packages: dict[str, Path]) -> object:
    shape = f'<collision><geometry><mesh filename="{address}"/></geometry></collision>'
    urdf = made(folder / "a.urdf", f'<robot name="a"><link name="l">{shape}</link></robot>')
    return load_geometry(urdf, packages)


def _visuals(folder: Path, address: str, packages: dict[str, Path]) -> object:
    shape = f'<visual><geometry><mesh filename="{address}"/></geometry></visual>'
    urdf = made(folder / "a.urdf", f'<robot name="a"><link name="l">{shape}</link></robot>')
    visuals, missing = load_visuals(urdf, packages)
    if missing:
        raise LoadError(missing[0])
    return visuals


def _scene(folder: Path, address: str, packages: dict[str, Path]) -> object:
    item = f"{{name: it, convex_mesh: {{file: '{address}'}}, position: [0, 0, 0]}}"
    return load_scene(made(folder / "s.yaml", f"shapes: [{item}]"), packages=packages)


@pytest.mark.parametrize("read", [_geometry, _visuals, _scene])
def test_robots_their_looks_and_scenes_look_in_the_same_places(
    tmp_path: Path, read: Callable[[Path, str, dict[str, Path]], object]
) -> None:
    import trimesh

    (tmp_path / "somewhere" / "meshes").mkdir(parents=True)
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "somewhere" / "meshes" / "box.stl")
    address = "package://things/meshes/box.stl"
    with pytest.raises(LoadError, match="package 'things' is nowhere"):
        read(tmp_path / "here", address, {})
    assert read(tmp_path / "here", address, {"things": tmp_path / "somewhere"})
