"""Plane snapping: what planes explain is exact, what they do not is left alone."""

import numpy as np
import pytest

from jaxpaint.refinement import PlaneSnappingSettings, snap_to_planes


def test_a_noisy_plane_gets_flat_and_right(flat):
    found = snap_to_planes(flat)
    assert found.statistics.supports == ((found.plane_of == 0).sum(),)
    assert found.statistics.explained > 0.99
    # 2,000 points: their plane errs by a 45th of the noise
    height = (found.points @ [0, 0.6, 0.8])[found.plane_of == 0]
    assert np.abs(height).mean() < 0.1 * 0.008
    on = found.points[found.plane_of == 0] @ found.planes[0, :3]
    np.testing.assert_allclose(on, found.planes[0, 3], atol=1e-12)


def test_both_faces_of_an_edge_are_found(folded):
    found = snap_to_planes(folded)
    assert len(found.planes) == 2
    normals = np.abs(found.planes[:, :3])
    assert sorted(normals.argmax(1)) == [0, 2]
    assert normals.max(1).min() > 0.999
    assert np.abs(found.points[:, [0, 2]]).min(1).mean() < 0.2 * np.abs(folded[:, [0, 2]]).min(1).mean()


def test_a_point_off_all_planes_stays(flat):
    stray = np.concatenate([flat, [[0.5, 0.5, 0.5], [0.2, 0.9, 0.4]]])
    found = snap_to_planes(stray)
    assert (found.plane_of[-2:] == -1).all()
    np.testing.assert_allclose(found.points[-2:], stray[-2:], atol=1e-15)


def test_a_cloud_without_planes_is_said_to_be_so():
    heap = np.random.default_rng(0).normal(size=(2_000, 3))
    ball = heap / np.linalg.norm(heap, axis=1, keepdims=True)
    found = snap_to_planes(ball).statistics
    assert found.explained < 0.9 and len(found.supports) > 5
    assert snap_to_planes(ball, PlaneSnappingSettings(share=0.5)).statistics.supports == ()
    np.testing.assert_allclose(
        snap_to_planes(ball, PlaneSnappingSettings(share=0.5)).points, ball, atol=1e-15
    )


def test_the_seed_decides(folded):
    first, second = (snap_to_planes(folded, PlaneSnappingSettings(seed=seed)) for seed in (3, 3))
    np.testing.assert_array_equal(first.planes, second.planes)
    np.testing.assert_array_equal(first.plane_of, second.plane_of)


def test_planes_are_those_of_the_cloud_as_it_came(flat):
    place = np.asarray([10.0, 20.0, 30.0])
    here, there = snap_to_planes(flat, viewpoint=np.ones(3)), snap_to_planes(flat + place)
    side = np.sign(there.planes[0, :3] @ here.planes[0, :3])
    assert side * there.planes[0, 3] == pytest.approx(here.planes[0, 3] + here.planes[0, :3] @ place)


@pytest.mark.parametrize("name", ["threshold", "share", "most", "samples"])
def test_a_setting_of_nothing_is_refused(name: str):
    with pytest.raises(ValueError, match=name):
        PlaneSnappingSettings(**{name: 0})
