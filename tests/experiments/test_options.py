"""Options: what is allowed, in words, and the round trip through a summary."""

import dataclasses
import json
import math
from typing import Annotated

import pytest

from experiments import values
from experiments.cli import parse
from experiments.commands.command import Command, RunOptions
from experiments.commands.paint_options import NOISES, PaintOptions
from experiments.options import from_config, to_config
from jaxpaint.errors import InputError


def test_the_defaults_are_those_of_the_contract():
    options = PaintOptions()
    options.check()
    assert (options.image, options.wall, options.worlds, options.seed) == (None, "flat", 64, 0)
    assert (options.fidelity, options.controller, options.refine) == ("kinematic", "acp", "none")
    assert (options.brush_radius, options.speed, options.noise) == (0.010, 0.03, "s1-simulation")


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"worlds": 0}, "--worlds"),
        ({"worlds": True}, "--worlds"),
        ({"speed": math.nan}, "--speed"),
        ({"speed": "fast"}, "--speed"),
        ({"canvas_size": (1.0, math.inf)}, "--canvas-size"),
        ({"canvas_size": (1.0,)}, "--canvas-size"),
        ({"halting": "yes"}, "--halting"),
        ({"wall": None}, "--wall"),
        ({"variance_bounds": (0.8, 0.3)}, "--variance-bounds"),
        ({"record": (0, 64)}, "--record"),
        ({"record": [0]}, "--record"),
        ({"record": (0, 0)}, "--record"),
    ],
)
def test_a_caller_in_python_meets_the_same_checks(change, name):
    with pytest.raises(InputError, match=name):
        PaintOptions(**change).check()


def test_every_option_survives_the_summary(tmp_path):
    image = tmp_path / "picture.svg"
    image.touch()
    options = PaintOptions(
        image=image, wall="corner", worlds=3, canvas_size=(0.6, 0.5), canvas_pose=(0.1, -2.0, 1.2, 1e-3),
        up="-y", speed=0.1, theta=0.25, variance_bounds=(0.2, 0.7), halting=False, seed=7, record=(2, 0),
    )  # fmt: skip
    config = json.loads(json.dumps(to_config(options)))
    assert from_config(PaintOptions, config, "summary.json") == options
    assert not {"out", "overwrite", "config"} & set(config)


def test_a_captured_wall_is_kept_by_its_full_name(tmp_path, monkeypatch):
    (tmp_path / "wall.PCD").touch()
    monkeypatch.chdir(tmp_path)
    options = from_config(PaintOptions, {"wall": "wall.PCD"}, "summary.json")
    options.check()
    assert to_config(options)["wall"] == str(tmp_path / "wall.PCD")
    assert options.captured() is not None
    assert PaintOptions(wall="corner").captured() is None


def test_an_unknown_key_of_a_config_is_named():
    with pytest.raises(InputError, match=r"'colour'.*brush_radius"):
        from_config(PaintOptions, {"colour": "red"}, "summary.json")


def test_switches_and_thresholds_reach_the_controller():
    from jaxpaint.decisions.thresholds import default_thresholds

    assert PaintOptions().threshold_changes() == {}
    off = PaintOptions(halting=False, low_speed=False, theta=0.3).threshold_changes()
    assert off == {"halt_travel": math.inf, "low_speed_scale": 0.0}
    given = PaintOptions(
        theta=0.3, dwell=0.0, release_margin=0.1, low_speed_scale=2.0, variance_bounds=(0.1, 0.2)
    )
    thresholds = default_thresholds(**given.threshold_changes())
    assert float(thresholds.halt_travel) == pytest.approx(0.3)
    assert float(thresholds.dwell) == 0.0
    assert float(thresholds.release_margin) == pytest.approx(0.1)
    assert float(thresholds.low_speed_scale) == 2.0
    assert (float(thresholds.variance_lower), float(thresholds.variance_upper)) == pytest.approx((0.1, 0.2))


def test_the_noise_presets_are_all_offered():
    from sims.noise import PRESETS

    assert set(NOISES) == set(PRESETS)


@dataclasses.dataclass(frozen=True, kw_only=True)
class _Several(RunOptions):
    """Options with a list."""

    export: Annotated[tuple[str, ...], values.several("csv", "json")] = ()
    """Files to write."""


@pytest.mark.parametrize(
    ("words", "export"),
    [
        ("", ()),
        ("--export csv", ("csv",)),
        ("--export json csv --seed 3", ("json", "csv")),
        ("--export none", ()),
    ],
)
def test_an_option_may_have_several_values(words, export):
    options = parse(Command("made-up", _Several, None), words.split())  # pyright: ignore
    options.check()
    assert options.export == export
    config = json.loads(json.dumps(to_config(options)))
    assert from_config(_Several, config, "summary.json").export == export


@pytest.mark.parametrize("export", [("svg",), ("csv", "csv"), "csv", None, ("csv", 1)])
def test_one_of_several_values_that_is_not_known_is_named(export):
    with pytest.raises(InputError, match=r"--export: found .*csv, json, each once"):
        _Several(export=export).check()


def test_a_repeat_is_not_told_on_what_to_run():
    options = PaintOptions(processes=2, memory_gb=3.0)
    assert not {"processes", "memory_gb", "coordinator", "process"} & set(to_config(options))
