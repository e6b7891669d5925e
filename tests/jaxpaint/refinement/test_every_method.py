"""What holds for every method of refinement, whatever it does."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxpaint.refinement import bilateral_filter, moving_least_squares, snap_to_planes

METHODS = [bilateral_filter, moving_least_squares, snap_to_planes]
NORMAL = np.asarray([0, 0.6, 0.8])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("cloud", ["flat", "folded"])
def test_a_rigid_motion_moves_the_result_alike(method, cloud: str, request):
    points = request.getfixturevalue(cloud)
    turn, shift = Rotation.from_rotvec([0.7, -0.2, 1.1]).as_matrix(), np.asarray([30.0, -20.0, 5.0])
    there = method(points @ turn.T + shift).points
    np.testing.assert_allclose(there, method(points).points @ turn.T + shift, atol=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_the_result_scales_with_the_cloud(method, folded):
    np.testing.assert_allclose(method(1_000 * folded).points, 1_000 * method(folded).points, atol=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_what_has_no_planes_and_no_scale_gives_no_nan(method, awkward, dtype):
    found = method(awkward.astype(dtype))
    assert found.points.shape == awkward.shape
    assert found.points.dtype == dtype
    assert np.isfinite(found.points).all()
    extent = np.linalg.norm(np.ptp(awkward, axis=0))
    assert np.linalg.norm(found.points - awkward, axis=1).max() <= extent + 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_an_exact_plane_stays_one(method, dtype):
    rng = np.random.default_rng(4)
    flat = np.stack([rng.uniform(0, 1, 500), rng.uniform(0, 1, 500), np.full(500, 0.25)], axis=1)
    found = method(flat.astype(dtype)).points
    np.testing.assert_allclose(found, flat, atol=1e-4 if dtype == np.float32 else 1e-10)


@pytest.mark.parametrize("method", METHODS)
def test_far_from_the_origin_single_precision_is_enough(method, flat):
    place = np.asarray([100.0, 200.0, 50.0])
    found = method((flat + place).astype(np.float32)).points
    # the cloud itself is only given to a hundredth of a millimetre there
    assert np.abs(found - (method(flat).points + place)).max() < 1e-3


@pytest.mark.parametrize("method", METHODS)
def test_the_same_cloud_gives_the_same_result(method, folded):
    np.testing.assert_array_equal(method(folded).points, method(folded).points)


@pytest.mark.parametrize("method", METHODS)
def test_displacements_are_told(method, flat):
    found = method(flat)
    moved = np.linalg.norm(found.points - flat, axis=1)
    told = found.statistics if method is not snap_to_planes else found.statistics.displacement
    assert told.mean == pytest.approx(moved.mean())
    assert told.p95 == pytest.approx(np.percentile(moved, 95))
    assert told.largest == pytest.approx(moved.max())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("side", [1, -1])
def test_normals_turn_to_the_viewpoint(method, side: int, flat):
    found = method(flat, viewpoint=flat.mean(0) + 3 * side * NORMAL)
    normals = found.planes[:, :3] if method is snap_to_planes else found.normals
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-6)
    assert (normals @ NORMAL * side > 0.95).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("points", "named"),
    [
        (np.zeros((9, 3)), "shape"),
        (np.zeros((20, 2)), "shape"),
        (np.zeros((20, 3), int), "int"),
        (np.full((20, 3), np.nan), "NaN"),
    ],
)
def test_what_is_no_cloud_is_refused(method, points, named: str):
    with pytest.raises(ValueError, match=named):
        method(points)
