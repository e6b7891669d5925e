"""Clouds from files: what is read, what is dropped, and what is refused in one line."""

import numpy as np
import pytest
from pypcd4 import Encoding, PointCloud

from jaxpaint.clouds import read_cloud, write_ply
from jaxpaint.errors import InputError


@pytest.fixture
def wall():
    """120 points of a wall and their colours, from a fixed seed; float32 as most files hold them."""
    generator = np.random.default_rng(3)
    points = generator.uniform([-1, 0, 1.0], [1, 2, 1.1], (120, 3)).astype(np.float32)
    return points, generator.integers(0, 256, (120, 3)).astype(np.uint8)


def _pcd(path, points, colours, encoding):
    packed = PointCloud.encode_rgb(colours).reshape(-1)
    columns = (*points.T, packed)
    PointCloud.from_points(columns, ("x", "y", "z", "rgb"), (np.float32,) * 4).save(path, encoding)


def _ply_text(points):
    body = "\n".join(" ".join(str(value) for value in row) for row in points)
    header = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
    return (
        header + f"property float z\nelement face 1\nproperty list uchar int i\nend_header\n{body}\n3 0 1 2\n"
    )


def _one_line(raised):
    message = str(raised.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("encoding", [Encoding.BINARY, Encoding.BINARY_COMPRESSED])
def test_pcd_with_packed_colours(tmp_path, wall, encoding):
    points, colours = wall
    _pcd(tmp_path / "wall.pcd", points, colours, encoding)
    cloud = read_cloud(tmp_path / "wall.pcd")
    np.testing.assert_array_equal(cloud.points, points)
    np.testing.assert_allclose(cloud.colours, colours / 255)
    assert cloud.points.dtype == np.float64 and cloud.shape is None and cloud.name == "wall.pcd"


def test_pcd_ascii_organised_with_missing_points(tmp_path, wall):
    points, _ = wall
    rows = ["nan nan nan", *(" ".join(str(value) for value in row) for row in points[1:])]
    header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 12\nHEIGHT 10\n"
    header += "VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 120\nDATA ascii\n"
    (tmp_path / "wall.pcd").write_text(header + "\n".join(rows) + "\n")
    cloud = read_cloud(tmp_path / "wall.pcd", scale=2.0)
    assert cloud.missing == 1 and cloud.shape == (10, 12)
    np.testing.assert_allclose(cloud.points, 2.0 * points[1:])
    np.testing.assert_allclose(cloud.viewpoint, [2.0, 4.0, 6.0])


def test_ply_written_is_read_again(tmp_path, wall):
    points, colours = wall
    write_ply(tmp_path / "wall.ply", points, colours / 255)
    cloud = read_cloud(tmp_path / "wall.ply")
    np.testing.assert_array_equal(cloud.points, points)
    np.testing.assert_allclose(cloud.colours, colours / 255)


def test_ply_ascii_and_big_endian(tmp_path, wall):
    points, _ = wall
    (tmp_path / "ascii.ply").write_text(_ply_text(points))
    header = _ply_text(points).split("end_header\n")[0].replace("ascii", "binary_big_endian")
    (tmp_path / "big.ply").write_bytes((header + "end_header\n").encode() + points.astype(">f4").tobytes())
    for name in ("ascii.ply", "big.ply"):
        np.testing.assert_allclose(read_cloud(tmp_path / name).points, points, rtol=1e-6)


def test_xyz_with_and_without_colours(tmp_path, wall):
    points, colours = wall
    np.savetxt(tmp_path / "plain.xyz", points)
    np.savetxt(tmp_path / "coloured.xyz", np.hstack([points, colours]))
    assert read_cloud(tmp_path / "plain.xyz").colours is None
    np.testing.assert_allclose(read_cloud(tmp_path / "coloured.xyz").colours, colours / 255)


def test_npz_takes_the_named_or_the_only_array(tmp_path, wall):
    points, _ = wall
    np.savez(tmp_path / "named.npz", points=points, normals=points)
    np.savez(tmp_path / "only.npz", anything=points, weights=np.ones(120))
    np.savez(tmp_path / "image.npz", points=points.reshape(10, 12, 3))
    for name, shape in (("named.npz", None), ("only.npz", None), ("image.npz", (10, 12))):
        cloud = read_cloud(tmp_path / name)
        np.testing.assert_array_equal(cloud.points, points)
        assert cloud.shape == shape


def test_ambiguous_and_pickled_npz_are_refused(tmp_path, wall):
    points, _ = wall
    np.savez(tmp_path / "two.npz", a=points, b=points)
    np.savez(tmp_path / "objects.npz", points=np.array([{"x": 1}] * 120, dtype=object))
    with pytest.raises(InputError, match="points"):
        read_cloud(tmp_path / "two.npz")
    with pytest.raises(InputError, match="pickled"):
        read_cloud(tmp_path / "objects.npz")


PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20


@pytest.mark.parametrize("suffix", [".pcd", ".ply", ".xyz", ".npz"])
@pytest.mark.parametrize("content", [b"", b"a shopping list\nmilk\n", PNG])
def test_other_files_under_a_cloud_name_are_refused(tmp_path, suffix, content):
    path = tmp_path / f"wall{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as raised:
        read_cloud(path)
    assert str(path) in _one_line(raised)


@pytest.mark.parametrize("keep", [0.3, 0.7, 0.98])
@pytest.mark.parametrize("kind", ["binary.pcd", "compressed.pcd", "ascii.pcd", "wall.ply", "wall.npz"])
def test_truncated_files_are_refused(tmp_path, wall, kind, keep):
    points, colours = wall
    path = tmp_path / kind
    if kind.endswith(".pcd"):
        names = {"binary": Encoding.BINARY, "compressed": Encoding.BINARY_COMPRESSED, "ascii": Encoding.ASCII}
        _pcd(path, points, colours, names[kind.split(".")[0]])
    elif kind.endswith(".ply"):
        write_ply(path, points, colours / 255)
    else:
        np.savez(path, points=points)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(keep * len(whole))])
    with pytest.raises(InputError) as raised:
        read_cloud(path)
    assert str(path) in _one_line(raised)


def test_paths_that_are_no_cloud(tmp_path):
    (tmp_path / "folder.pcd").mkdir()
    (tmp_path / "wall.docx").write_text("x")
    for name, says in (
        ("none.pcd", "no such file"),
        ("folder.pcd", "folder"),
        ("wall.docx", ".ply, .pcd, .xyz, .npz"),
    ):
        with pytest.raises(InputError, match=says) as raised:
            read_cloud(tmp_path / name)
        assert name in _one_line(raised)


def test_too_few_finite_points(tmp_path, wall):
    points = wall[0].copy()
    points[:30, 1] = np.nan
    np.savez(tmp_path / "wall.npz", points=points)
    with pytest.raises(InputError, match="90 finite points and 30 missing, at least 100"):
        read_cloud(tmp_path / "wall.npz")


def test_equal_points_and_wrong_units(tmp_path, wall):
    np.savez(tmp_path / "equal.npz", points=np.ones((200, 3)))
    np.savez(tmp_path / "millimetres.npz", points=1000.0 * wall[0])
    with pytest.raises(InputError, match="equal"):
        read_cloud(tmp_path / "equal.npz")
    with pytest.raises(InputError, match=r"19\d\d m wide.*--wall-scale 0.001"):
        read_cloud(tmp_path / "millimetres.npz")
    assert np.ptp(read_cloud(tmp_path / "millimetres.npz", scale=0.001).points) < 4.0


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf")])
def test_scale_must_be_a_positive_number(tmp_path, scale):
    with pytest.raises(InputError, match="--wall-scale"):
        read_cloud(tmp_path / "wall.pcd", scale=scale)


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "points", "missing", "shape"),
    [("pcl_capture0001", 249647, 57553, (480, 640)), ("o3d_fragment", 113662, 0, None)],
)
def test_real_captures(shared_data, name, points, missing, shape):
    cloud = read_cloud(shared_data / "clouds" / f"{name}.pcd")
    assert (len(cloud.points), cloud.missing, cloud.shape) == (points, missing, shape)
    assert (cloud.colours is None) == (name == "pcl_capture0001")
