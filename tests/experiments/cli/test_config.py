"""--config repeats an earlier run, with what is given on top."""

import json

from experiments.cli import main


def paint(line: str) -> int:
    return main(["paint", *line.split()])


def test_config_repeats_a_run_with_what_is_given_on_top(pipeline, capture):
    first_line = (
        f"paint --worlds 5 --speed 0.05 {capture} --up -y --canvas-pose 0 -1 1.2 0.1 --seed 9 --out a"
    )
    second_line = "paint --config a/summary.json --speed 0.04 --out b"
    assert main(first_line.split()) == 0
    assert main(second_line.split()) == 0
    first, second = pipeline.options
    assert second.worlds == 5
    assert second.seed == 9
    assert second.up == "-y"
    assert second.canvas_pose == (0.0, -1.0, 1.2, 0.1)
    assert second.speed == 0.04
    assert second.theta == pipeline.outcome.resolved["theta"]
    assert first.speed == 0.05


def test_what_the_program_chose_is_dropped_with_what_it_was_chosen_by(pipeline, tmp_path, capture):
    """The pipeline chose canvas_size and theta."""
    assert paint("--wall corner --dwell 0.7 --out a") == 0
    assert json.loads((tmp_path / "a" / "summary.json").read_text())["chosen"] == ["canvas_size", "theta"]
    again = "--config a/summary.json"
    both = ("canvas_size", "theta")
    for line, size, theta, chosen in (
        ("", (2.4, 0.8), 0.4, both),
        ("--wall corner", (2.4, 0.8), 0.4, both),
        ("--wall flat", None, 0.4, ("theta",)),
        ("--wall flat --canvas-size 1 2", (1.0, 2.0), 0.4, ("theta",)),
        ("--halting --theta 0.4", (2.4, 0.8), 0.4, ("canvas_size",)),
    ):
        assert paint(f"{again} {line}") == 0
        options = pipeline.options[-1]
        assert (options.canvas_size, options.theta, options.chosen) == (size, theta, chosen), line
        assert options.dwell == 0.7, "given to the first run"
    assert paint(f"{again} {capture} --no-halting") == 0
    options = pipeline.options[-1]
    assert (options.canvas_size, options.theta, options.dwell, options.chosen) == (None, None, None, ())


def test_a_repeat_on_another_wall_drops_what_only_a_captured_one_needs(pipeline, capture, tmp_path):
    (tmp_path / "photo.png").touch()
    given = f"{capture} --up -y --wall-scale 0.001 --wall-height 0.5 --image photo.png --colours 2"
    assert main(f"paint {given} --export csv --export-world 3 --out a".split()) == 0
    assert paint("--config a/summary.json --wall flat --export none --out b") == 0
    options = pipeline.options[-1]
    assert (options.up, options.wall_scale, options.wall_height) == (None, 1.0, None)
    assert (options.export, options.export_world, options.colours) == ((), 0, 2)
    (tmp_path / "line.svg").touch()
    assert paint("--config a/summary.json --image line.svg --out c") == 0
    options = pipeline.options[-1]
    assert (options.up, options.colours, options.export_world) == ("-y", 0, 3)
    assert paint("--config a/summary.json --wall flat --up -y") == 2


def test_a_repeat_of_a_repeat_still_knows_what_was_chosen(pipeline, tmp_path):
    assert paint("--out a") == 0
    assert paint("--config a/summary.json --out b") == 0
    first, second = (json.loads((tmp_path / name / "summary.json").read_text()) for name in "ab")
    assert first["chosen"] == second["chosen"] == ["canvas_size", "theta"]
    assert first["config"] == second["config"]
