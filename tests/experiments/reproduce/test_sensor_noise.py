"""The rows and the picture of fitted sensor noise."""

import pytest

from experiments.reproduce import ReproduceSettings
from experiments.reproduce.sensor_noise import preset_rows, run
from sims.sensors import DepthNoise


def test_the_fit_of_the_presets_own_pictures_is_the_preset():
    sigma, correlation, white, quantum = preset_rows(draws=20, seed=0)
    assert (sigma.published, quantum.published) == (0.08, 1 / 32)
    assert sigma.ours == pytest.approx(0.08, rel=0.03)
    assert sigma.low < sigma.ours < sigma.high
    assert correlation.ours == pytest.approx(float(DepthNoise().correlation), rel=0.03)
    assert white.ours < 0.01
    assert quantum.ours == pytest.approx(1 / 32, rel=1e-3)


def test_without_data_it_is_refused():
    with pytest.raises(ValueError, match="data: found none"):
        run(ReproduceSettings())


@pytest.mark.realdata
def test_every_source_has_its_rows(shared_data):
    result = run(ReproduceSettings(data=shared_data), draws=10)
    assert {row["variant"] for row in result.table} == {"ours", "kinect", "rgbd frames", "fragment"}
    values = {row["name"]: row["ours"] for row in result.table if row["variant"] == "kinect"}
    assert 0.04 < values["of which stays with the camera [px]"] < 0.08
    assert 0.01 < values["residual of the plane 'wall' [m]"] < 0.02
    assert all(row["published"] is None for row in result.table if row["variant"] != "ours")
    assert list(result.figures) == ["plane residuals"]
    figure = result.figures["plane residuals"]
    assert [len(axes.collections) > 0 for axes in figure.axes] == [True, True]
