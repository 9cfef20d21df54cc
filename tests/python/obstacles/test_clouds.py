"""Reading point clouds: every format gives the same points, and bad files give one clear error."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from pypcd4 import Encoding, PointCloud

from pdoik import LoadError
from pdoik.clouds import load_cloud

POINTS = np.random.default_rng(3).uniform(-2, 2, (57, 3)).astype(np.float32).astype(np.float64)


def write_pcd(path: Path, encoding: Encoding, points: np.ndarray = POINTS) -> Path:
    PointCloud.from_xyz_points(points.astype(np.float32)).save(path, encoding=encoding)
    return path


def write_ply(path: Path, encoding: str, points: np.ndarray = POINTS) -> Path:
    path.write_bytes(trimesh.PointCloud(points).export(file_type="ply", encoding=encoding))
    return path


@pytest.mark.parametrize("encoding", [Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED])
def test_pcd_in_each_encoding_gives_the_points(tmp_path: Path, encoding: Encoding) -> None:
    cloud = load_cloud(write_pcd(tmp_path / "cloud.pcd", encoding))
    assert cloud.shape == (57, 3)
    assert cloud.dtype == np.float64
    assert cloud.flags.c_contiguous
    np.testing.assert_allclose(cloud, POINTS, atol=1e-6)


def test_pcd_with_other_fields_and_doubles_gives_the_points(tmp_path: Path) -> None:
    columns = [np.arange(57, dtype=np.uint32), POINTS[:, 2], POINTS[:, 0], POINTS[:, 1]]
    types = [np.uint32, np.float64, np.float64, np.float64]
    path = tmp_path / "cloud.pcd"
    PointCloud.from_points(columns, ("rgb", "z", "x", "y"), types).save(path)
    np.testing.assert_array_equal(load_cloud(path), POINTS)


def test_pcd_of_one_point_has_one_row(tmp_path: Path) -> None:
    path = write_pcd(tmp_path / "one.pcd", Encoding.ASCII, POINTS[:1])
    np.testing.assert_allclose(load_cloud(path), POINTS[:1], atol=1e-6)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_ply_gives_the_points(tmp_path: Path, encoding: str) -> None:
    np.testing.assert_allclose(
        load_cloud(write_ply(tmp_path / "c.ply", encoding)), POINTS, atol=1e-6
    )


def test_ply_of_a_mesh_gives_every_vertex_in_order(tmp_path: Path) -> None:
    mesh = trimesh.creation.box((0.1, 0.2, 0.3))
    path = tmp_path / "mesh.ply"
    mesh.export(path)
    np.testing.assert_allclose(load_cloud(path), mesh.vertices, atol=1e-7)


def test_npy_may_be_organised_as_an_image(tmp_path: Path) -> None:
    path = tmp_path / "cloud.npy"
    np.save(path, POINTS.reshape(19, 3, 3))
    np.testing.assert_array_equal(load_cloud(path), POINTS)


@pytest.mark.parametrize(
    ("name", "header", "delimiter"),
    [("c.xyz", "", " "), ("c.txt", "# x y z\n// a remark\n", "\t"), ("c.csv", "x,y,z\n", ",")],
)
def test_columns_of_text_give_the_points(
    tmp_path: Path, name: str, header: str, delimiter: str
) -> None:
    path = tmp_path / name
    rows = "\n".join(delimiter.join(repr(float(value)) for value in row) for row in POINTS)
    path.write_text(f"{header}{rows}\n\n")
    np.testing.assert_array_equal(load_cloud(path), POINTS)


def test_named_columns_are_found_by_name(tmp_path: Path) -> None:
    path = tmp_path / "cloud.csv"
    path.write_text('intensity,"Z",X,Y\n9,3,1,2\n9,6,4,5\n')
    np.testing.assert_array_equal(load_cloud(path), [[1, 2, 3], [4, 5, 6]])


def test_columns_beyond_the_third_are_ignored(tmp_path: Path) -> None:
    path = tmp_path / "cloud.xyz"
    path.write_text("1 2 3 255 0 0\n4 5 6 0 255 0\n")
    np.testing.assert_array_equal(load_cloud(path), [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize("suffix", [".pcd", ".ply", ".npy", ".xyz"])
def test_rows_with_nan_or_infinity_are_left_out(tmp_path: Path, suffix: str) -> None:
    points = POINTS.copy()
    points[5, 1], points[8], points[11, 0] = np.nan, np.nan, np.inf
    path = tmp_path / f"cloud{suffix}"
    if suffix == ".pcd":
        write_pcd(path, Encoding.BINARY, points)
    elif suffix == ".ply":
        write_ply(path, "binary", points)
    elif suffix == ".npy":
        np.save(path, points)
    else:
        np.savetxt(path, points)
    expected = np.delete(POINTS, [5, 8, 11], axis=0)
    np.testing.assert_allclose(load_cloud(path), expected, atol=1e-6)


def refuses(path: Path, *words: str) -> None:
    with pytest.raises(LoadError) as caught:
        load_cloud(path)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    for word in words:
        assert word in message


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    refuses(tmp_path / "none.pcd", "no such file")


def test_a_folder_is_no_cloud(tmp_path: Path) -> None:
    (tmp_path / "dir.pcd").mkdir()
    refuses(tmp_path / "dir.pcd", "folder")


def test_an_unknown_suffix_is_told_what_there_is(tmp_path: Path) -> None:
    path = tmp_path / "cloud.las"
    path.write_bytes(b"LASF")
    refuses(path, ".pcd", ".las")


def pcd_header(*, points: int, data: str, count: str = "1 1 1") -> bytes:
    return (
        f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT {count}\n"
        f"WIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    ).encode()


@pytest.mark.parametrize("data", ["ascii", "binary", "binary_compressed"])
def test_pcd_that_promises_more_than_its_size_can_hold_is_refused_unread(
    tmp_path: Path, data: str
) -> None:
    path = tmp_path / "cloud.pcd"
    path.write_bytes(pcd_header(points=10**12, data=data) + b"0 0 0\n" * 20)
    refuses(path, "promises 1000000000000 points", "size")


def test_pcd_with_a_billion_columns_is_refused_before_they_are_named(tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    path.write_bytes(pcd_header(points=1, data="ascii", count="1 1 1000000000") + b"0 0 0\n")
    refuses(path, "1000000002", "columns")


def test_pcd_whose_points_compress_to_almost_nothing_is_read(tmp_path: Path) -> None:
    path = write_pcd(tmp_path / "cloud.pcd", Encoding.BINARY_COMPRESSED, np.zeros((50_000, 3)))
    assert path.stat().st_size < 50_000 * 12 / 50
    np.testing.assert_array_equal(load_cloud(path), np.zeros((50_000, 3)))


def test_ply_of_a_textured_mesh_gives_the_vertices_that_the_file_has(tmp_path: Path) -> None:
    path = tmp_path / "textured.ply"
    path.write_text(
        "ply\nformat ascii 1.0\ncomment TextureFile nowhere.png\nelement vertex 3\n"
        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n3 0 1 2 6 .5 0 1 0 0 1\n"
    )
    np.testing.assert_array_equal(load_cloud(path), [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize("suffix", [".pcd", ".ply", ".npy", ".xyz", ".csv"])
@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n\n",
        b"# only a remark\n",
        bytes(range(256)) * 8,
        b"hello world\n" * 50,
        b"x,y,z\n1,2\n",
    ],
    ids=["empty", "blank", "remark", "bytes", "words", "too few columns"],
)
def test_garbage_is_refused_in_every_format(tmp_path: Path, suffix: str, content: bytes) -> None:
    path = tmp_path / f"garbage{suffix}"
    path.write_bytes(content)
    refuses(path)


@pytest.mark.parametrize("encoding", [Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED])
@pytest.mark.parametrize("kept", [0.2, 0.6, 0.95])
def test_a_pcd_cut_short_is_refused(tmp_path: Path, encoding: Encoding, kept: float) -> None:
    path = write_pcd(tmp_path / "cloud.pcd", encoding)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    refuses(path)


def test_a_pcd_cut_between_two_points_is_refused(tmp_path: Path) -> None:
    path = write_pcd(tmp_path / "cloud.pcd", Encoding.BINARY)
    path.write_bytes(path.read_bytes()[: -10 * 12])
    refuses(path, "57", "47")


@pytest.mark.parametrize("kept", [0.2, 0.6, 0.95])
@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_a_ply_cut_short_is_refused(tmp_path: Path, encoding: str, kept: float) -> None:
    path = write_ply(tmp_path / "cloud.ply", encoding)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    refuses(path)


def test_an_npy_cut_short_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cloud.npy"
    np.save(path, POINTS)
    path.write_bytes(path.read_bytes()[:-100])
    refuses(path)


def test_an_npy_is_never_unpickled(tmp_path: Path) -> None:
    path = tmp_path / "cloud.npy"
    np.save(path, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    refuses(path)


@pytest.mark.parametrize("shape", [(5,), (5, 2), (5, 4), (2, 5, 4)])
def test_an_npy_of_another_shape_is_refused(tmp_path: Path, shape: tuple[int, ...]) -> None:
    path = tmp_path / "cloud.npy"
    np.save(path, np.ones(shape))
    refuses(path, "(N, 3)")


def test_a_pcd_without_coordinates_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cloud.pcd"
    PointCloud.from_points([POINTS[:, 0]], ("range",), [np.float64]).save(path)
    refuses(path, "x, y, z", "range")


def test_a_cloud_of_nothing_but_nan_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cloud.npy"
    np.save(path, np.full((7, 3), np.nan))
    refuses(path, "7 rows")


def test_rows_of_different_length_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "cloud.xyz"
    path.write_text("1 2 3\n4 5\n")
    refuses(path)
