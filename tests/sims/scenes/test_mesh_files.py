"""Files of meshes: what is read, and what is refused in one line before it is loaded."""

import struct

import numpy as np
import pytest
import trimesh

from jaxpaint.clouds import write_ply
from jaxpaint.errors import InputError
from sims.scenes import is_mesh, mesh_wall, read_mesh, read_wall
from sims.scenes.mesh_checks import check_mesh
from sims.scenes.polygons import cut, triangulate

BOX = trimesh.creation.box(extents=(0.4, 2.0, 1.5))


def _area(mesh):
    sides = mesh.corners[:, 1:] - mesh.corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_all_kinds_hold_the_same_box(tmp_path, kind):
    path = tmp_path / f"box.{kind}"
    BOX.export(path)
    mesh = read_mesh(path, scale=0.5)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [0.2, 1.0, 0.75], rtol=1e-6)
    assert _area(mesh) == pytest.approx(0.25 * BOX.area, rel=1e-6) and is_mesh(path)
    checks = check_mesh(mesh)
    assert (checks.faces, checks.bodies, checks.rims, checks.crowded, checks.flipped) == (12, 1, 0, 0, 0)


def test_text_stl_and_joined_bodies(tmp_path):
    two = trimesh.util.concatenate([BOX, BOX.copy().apply_translation([0, 3, 0])])
    (tmp_path / "two.stl").write_text(trimesh.exchange.stl.export_stl_ascii(two))
    assert check_mesh(read_mesh(tmp_path / "two.stl")).bodies == 2


# A wall 4 x 3 m with a door 1 x 2 m as one polygon: a fan would fill the door.
DOOR = [(0, 0), (1.5, 0), (1.5, 2), (2.5, 2), (2.5, 0), (4, 0), (4, 3), (0, 3)]


def test_polygons_keep_what_they_leave_open(tmp_path):
    lines = [f"v 0 {y} {z}" for y, z in DOOR] + ["f 1 2 3 4 \\", " 5/1/1 6//2 -2 -1"]
    (tmp_path / "door.obj").write_text("\n".join(lines))
    mesh = read_mesh(tmp_path / "door.obj")
    assert len(mesh.faces) == 6 and _area(mesh) == pytest.approx(10.0)


def _polygons_ply(order, polygons, scale=1):
    """Vertices of DOOR with a colour, faces with a flag before and a list behind their corners."""
    head = (
        f"ply\nformat {order} 1.0\ncomment by hand\nelement vertex {len(DOOR)}\nproperty double x\n"
        "property float y\nproperty float z\nproperty uchar red\n"
        f"element face {len(polygons)}\nproperty uchar flag\nproperty list uchar uint vertex_indices\n"
        "property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n"
    ).encode()
    if order == "ascii":
        rows = [f"0 {y} {z} 9" for y, z in DOOR]
        rows += [f"1 {len(p)} {' '.join(map(str, p))} 2 0.5 0.5" for p in polygons]
        return head + "\n".join([*rows, "7"]).encode()
    end = "<" if "little" in order else ">"
    body = b"".join(struct.pack(end + "dffB", 0, y, z, 9) for y, z in DOOR)
    for p in polygons:
        body += struct.pack(f"{end}BB{len(p)}IB2f", 1, len(p), *p, 2, 0.5, 0.5)
    return head + body + struct.pack(end + "i", 7)


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize(
    ("polygons", "faces", "area"),
    [
        ([range(8)], 6, 10.0),
        ([(0, 1, 2, 7), (7, 2, 3, 6), (3, 4, 5, 6)], 6, 10.0),
        ([(0, 1, 2), (0, 2, 7), (7, 2, 3, 6), (3, 4, 5, 6)], 6, 10.0),
        ([(0, 1, 2), (0, 2, 7)], 2, 3.75),
    ],
)
def test_polygons_of_ply_files(tmp_path, order, polygons, faces, area):
    (tmp_path / "door.ply").write_bytes(_polygons_ply(order, polygons))
    mesh = read_mesh(tmp_path / "door.ply")
    assert len(mesh.faces) == faces and _area(mesh) == pytest.approx(area)


def test_quads_at_once_are_the_quads_one_by_one():
    """Convex, concave, flat in one corner and crossing themselves, at any angle in space."""
    rng = np.random.default_rng(0)
    flat = rng.uniform(size=(300, 4, 2)) @ np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
    flat[::10, 1] = (flat[::10, 0] + flat[::10, 2]) / 2
    points, quads = flat.reshape(-1, 3), np.arange(1200).reshape(-1, 4)
    quads[1::2] = quads[1::2, ::-1]
    found = cut(points, quads.ravel(), np.full(300, 4))
    one_by_one = [triangulate(points, quad.tolist()) for quad in quads]

    def as_sets(triangles):
        return [{frozenset(t) for t in pair} for pair in np.reshape(triangles, (-1, 2, 3)).tolist()]

    assert as_sets(found) == as_sets(one_by_one)
    normal = np.cross(*(points[found[:, k]] - points[found[:, 0]] for k in (1, 2)))
    expected = np.array(one_by_one).reshape(-1, 3)
    other = np.cross(*(points[expected[:, k]] - points[expected[:, 0]] for k in (1, 2)))
    assert np.sum(normal * other, axis=1).min() > -1e-12


def test_polygons_of_all_sizes_keep_their_order():
    points = np.array([(0, y, z) for y, z in DOOR], dtype=float)
    corners = np.array([0, 1, 2, 7, 3, 4, 5, 5, 6, *range(8), 4, 5, 6])
    found = cut(points, corners, np.array([4, 3, 2, 8, 0, 3]))
    assert found[2].tolist() == [3, 4, 5] and found[-1].tolist() == [4, 5, 6] and len(found) == 2 + 1 + 6 + 1


def test_a_polygon_with_a_seam_to_its_hole():
    outer, inner = [(0, 0), (3, 0), (3, 3), (0, 3)], [(1, 1), (1, 2), (2, 2), (2, 1)]
    ring = [*outer, outer[0], *inner, inner[0]]
    points = np.column_stack([ring, np.zeros(len(ring))]).astype(float)
    triangles = points[np.array(triangulate(points, list(range(len(ring)))))][:, :, :2]
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    turns = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    assert np.all(turns >= -1e-12) and turns.sum() / 2 == pytest.approx(8.0)


def test_defects_are_counted(tmp_path):
    """A sheet of 4 x 4 squares without one in the middle, a fin on it, a turned face and an empty one."""
    grid = {(i, j): 5 * i + j for i in range(5) for j in range(5)}
    faces = []
    for i in range(4):
        for j in range(4):
            if (i, j) != (1, 1):
                a, b, c, d = grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]
                faces += [(a, b, c), (a, c, d)]
    faces[-1] = faces[-1][::-1]
    faces += [(grid[3, 0], grid[3, 1], 25), (grid[0, 0], grid[1, 0], grid[2, 0])]
    points = [(0, 0.5 * j, 0.5 * i) for i, j in grid] + [(0.3, 0.25, 1.5)]
    text = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "sheet.obj").write_text("\n".join(text))
    checks = check_mesh(read_mesh(tmp_path / "sheet.obj"))
    assert (checks.crowded, checks.degenerate, checks.bodies, checks.rims) == (1, 1, 1, 1)
    assert checks.flipped == 2 and checks.holes == pytest.approx((0.5,))


def _ply(vertices, faces):
    return (
        f"ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()


def _stl(faces, body=b""):
    return bytes(80) + int(faces).to_bytes(4, "little") + body


TRIANGLE = b"v 0 0 0\nv 0 1 0\nv 0 0 1\n"
BAD = {
    "missing.stl": (None, "no such file"),
    "empty.obj": (b"", "the file is empty"),
    "huge.ply": (_ply(30_000_000, 10_000_000), "10000000 faces or more found, at most 2000000"),
    "cut.ply": (_ply(3, 1) + b"0 0 0\n0 1", "not a readable .ply"),
    "half.ply": (_ply(3, 1) + b"0 0 0 0 1 0 0 0 1 3 0 1 1.5", "not a readable .ply"),
    "word.ply": (_ply(3, 1) + b"0 0 0 0 1 0 0 0 1 3 0 1 two", "not a readable .ply"),
    "ends.ply": (_ply(3, 2) + b"0 0 0 0 1 0 0 0 1 3 0 1 2 9 0 1 2", "not a readable .ply"),
    "past.ply": (_ply(3, 1) + b"0 0 0 0 1 0 0 0 1 3 0 1 3", "vertices that are not there"),
    "noply.ply": (b"hello", "no .ply header"),
    "short.stl": (_stl(5, bytes(60)), "no .stl"),
    "words.stl": (b"solid but nothing else", "no faces found|not a readable"),
    "picture.obj": (bytes(range(256)) * 4, "no faces found"),
    "nan.obj": (TRIANGLE + b"v nan 0 0\nf 1 2 3\nf 1 2 4\n", "1 vertices are not finite"),
    "faceless.obj": (TRIANGLE, "no faces found"),
    "beyond.obj": (TRIANGLE + b"f 1 2 9\n", "vertices that are not there"),
    "letters.obj": (TRIANGLE + b"f 1 two 3\n", "line 4: 'f 1 two 3'"),
    "flat.obj": (b"v 0 0 0\nv 0 1 0\nv 0 2 0\nf 1 2 3\n", "no area"),
    "mesh.dae": (b"x", "allowed: .stl, .obj, .ply"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_in_one_line(tmp_path, name):
    content, message = BAD[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message) as raised:
        read_mesh(tmp_path / name)
    assert "\n" not in str(raised.value) and name in str(raised.value)


@pytest.mark.parametrize(
    "lines",
    [
        "f\t1 2 3\n",
        "  f 1 2 3\n",
        "f 1 2 3 1 2\n",
        "f 1 \\\n 2 3 # of three\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    ],
)
def test_faces_of_obj_files_are_counted_however_they_are_written(tmp_path, monkeypatch, lines):
    """A polygon counts as the triangles that it is cut into."""
    monkeypatch.setattr("sims.scenes.mesh_files.MAX_FACES", 99)
    (tmp_path / "much.obj").write_bytes(TRIANGLE + lines.encode() * (34 if "2 3 1 2" in lines else 100))
    with pytest.raises(InputError, match=r"10\d faces or more found, at most 99 are allowed"):
        read_mesh(tmp_path / "much.obj")


def test_faces_in_large_letters_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr("sims.scenes.mesh_files.MAX_FACES", 11)
    (tmp_path / "box.stl").write_text(trimesh.exchange.stl.export_stl_ascii(BOX).upper())
    with pytest.raises(InputError, match="12 faces or more found, at most 11 are allowed"):
        read_mesh(tmp_path / "box.stl")


def test_a_polygon_of_a_ply_counts_as_its_triangles(tmp_path, monkeypatch):
    monkeypatch.setattr("sims.scenes.mesh_files.MAX_FACES", 5)
    (tmp_path / "door.ply").write_bytes(_polygons_ply("ascii", [range(8)]))
    with pytest.raises(InputError, match="6 faces or more found, at most 5 are allowed"):
        read_mesh(tmp_path / "door.ply")


@pytest.mark.parametrize("name", ["big.stl", "big.obj"])
def test_ten_million_faces_are_counted_not_loaded(tmp_path, name):
    with (tmp_path / name).open("wb") as file:
        if name == "big.stl":
            file.write(_stl(10_000_000))
            file.truncate(84 + 50 * 10_000_000)
        else:
            file.write(TRIANGLE + b"f 1 2 3\n" * 2_100_000)
    with pytest.raises(InputError, match="at most 2000000 are allowed"):
        read_mesh(tmp_path / name)


@pytest.mark.parametrize(
    ("scale", "hint"), [(1000.0, "0.001 .millimetres"), (39.37, "0.0254 .inches"), (0.01, "1000|try --wall")]
)
def test_a_size_that_is_none_of_a_wall_names_the_units(tmp_path, scale, hint):
    BOX.copy().apply_scale(scale).export(tmp_path / "box.stl")
    with pytest.raises(InputError, match=f"m across with --wall-scale 1, .*{hint}"):
        read_mesh(tmp_path / "box.stl")


def test_points_alone_are_a_cloud_and_faces_a_mesh(tmp_path):
    v, u = np.meshgrid(np.linspace(0, 1.5, 90), np.linspace(-1, 1, 120))
    write_ply(tmp_path / "cloud.ply", np.column_stack([np.full(v.size, 2.0), u.ravel(), v.ravel()]))
    assert not is_mesh(tmp_path / "cloud.ply")
    with pytest.raises(InputError, match="points alone is a cloud"):
        mesh_wall(tmp_path / "cloud.ply")
    BOX.export(tmp_path / "mesh.ply")
    assert type(read_wall(tmp_path / "mesh.ply", up="z", canvas_size=(0.5, 0.5))).__name__ == "MeshWall"
    assert type(read_wall(tmp_path / "cloud.ply", up="z", canvas_size=(0.5, 0.5))).__name__ == "CapturedWall"


def test_a_mesh_of_slivers_alone(tmp_path):
    (tmp_path / "sliver.obj").write_text("v 0 0 0\nv 0 1 0\nv 0 2 1e-12\nf 1 2 3\n")
    with pytest.raises(InputError, match=r"sliver\.obj: none of the 1 faces has an area") as raised:
        mesh_wall(tmp_path / "sliver.obj")
    assert "\n" not in str(raised.value)


def test_a_mesh_without_anything_upright(tmp_path):
    trimesh.creation.box(extents=(2, 2, 0.01)).export(tmp_path / "floor.stl")
    with pytest.raises(
        InputError, match=r"floor.stl: no upright surface found with up = \+z; try --up with x, y"
    ):
        mesh_wall(tmp_path / "floor.stl", up="z")
    assert mesh_wall(tmp_path / "floor.stl", canvas_size=(0.5, 0.5)).report.up == "+y"
