"""The marked planes of real and rendered pictures, and what is fitted to them."""

import numpy as np
import pytest

from experiments.sensing import (
    FILES,
    KINECT,
    RENDERED,
    depths,
    fragment_residuals,
    missing_file,
    patches,
)
from sims.sensors import DepthNoise
from sims.sensors.noise_fit import bootstrap, fit_noise, quantum_of


def test_the_first_missing_file_is_named(tmp_path):
    assert missing_file(tmp_path) == FILES[0]
    for name in FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert missing_file(tmp_path) is None


@pytest.mark.realdata
@pytest.mark.parametrize("source", [KINECT, RENDERED], ids=lambda source: source.name)
def test_every_mark_is_a_plane_in_every_picture(shared_data, source):
    found = patches(source, depths(source, shared_data))
    assert len(found) == len(source.files) * len(source.marks)
    for one in found:
        assert np.isnan(one.residual.residual).mean() < 0.01
        assert one.residual.rms < 0.15
        assert 0.9 < one.distance < 2.7


@pytest.mark.realdata
def test_the_shipped_noise_is_that_of_the_kinect_where_nothing_is_published(shared_data):
    pictures = depths(KINECT, shared_data)
    quantum = quantum_of(pictures[0], KINECT.focal_baseline)
    # A Kinect delivers 1/8 px of its own focal length of about 580 px.
    assert quantum == pytest.approx(525 / 580 / 8, rel=0.02)
    found = [one.residual for one in patches(KINECT, pictures) if one.fitted]
    fit, low, high = bootstrap(found, quantum, 60, seed=0)
    shipped = DepthNoise()
    assert low.correlation < float(shipped.correlation) < high.correlation
    assert float(shipped.correlation) == pytest.approx(fit.correlation, rel=0.02)
    # What is published of a D435 is more than a Kinect has, and the model leaves little out.
    assert high.sigma < float(shipped.disparity_sigma)
    assert fit.white < 0.4 * fit.sigma


@pytest.mark.realdata
def test_rendered_noise_is_less_alike_than_real_noise(shared_data):
    pictures = depths(RENDERED, shared_data)
    found = [one.residual for one in patches(RENDERED, pictures) if one.fitted]
    fit = fit_noise(found, quantum_of(pictures[0], RENDERED.focal_baseline))
    assert fit.white > 2 * fit.sigma


@pytest.mark.realdata
def test_plaster_of_the_fragment_is_plane_to_two_millimetres(shared_data):
    rms = fragment_residuals(shared_data)
    assert rms.shape == (6,)
    assert ((rms > 0.001) & (rms < 0.002)).all()
