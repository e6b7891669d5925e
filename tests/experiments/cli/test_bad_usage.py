"""Bad usage and bad input: one line, exit status 2, nothing left behind."""

import json

import pytest

from experiments.cli import main

BAD = {
    "": "command",
    "pain": "pain",
    "paint --colour red": "--colour",
    "paint --worlds": "--worlds",
    "paint --worlds 0": "--worlds",
    "paint --worlds -3": "--worlds",
    "paint --worlds 2.5": "--worlds",
    "paint --worlds many": "--worlds",
    "paint --worlds=": "--worlds",
    "paint --speed -1": "--speed",
    "paint --speed 0": "--speed",
    "paint --speed inf": "--speed",
    "paint --brush-radius nan": "--brush-radius",
    "paint --wall-scale 0": "--wall-scale",
    "paint --wall-height -1": "--wall-height",
    "paint --theta nan": "--theta",
    "paint --dwell -1": "--dwell",
    "paint --seed -1": "--seed",
    "paint --seed 99999999999": "--seed",
    "paint --canvas-size 1": "--canvas-size",
    "paint --canvas-size 1 0": "--canvas-size",
    "paint --canvas-size 1 2 3": "3",
    "paint --canvas-pose 0 0 nan 0": "--canvas-pose",
    "paint --up w": "--up",
    "paint --up -w": "--up",
    "paint --friction 0.5": "beside --fidelity wheeled",
    "paint --fidelity wheeled --friction 0": "above 0",
    "paint --fidelity wheeled --friction 1e300": "of 5 or less",
    "paint --randomise 30": "to 4",
    "paint --refine agn": "not built yet",
    "paint --fidelity hover": "--fidelity",
    "paint --controller pid": "acp, whole-body, trajectory",
    "paint --noise loud": "s1-simulation",
    "paint --wall moon": "flat, corner, cylinder",
    "paint --wall text.txt": "text.txt",
    "paint --image nowhere.svg": "nowhere.svg",
    "paint --image text.txt": "text.txt",
    "paint --robot text.txt": "--robot",
    "paint --variance-bounds 0.8 0.3": "--variance-bounds",
    "paint --wall flat --up=-y": "--up: found '-y' (no effect)",
    "paint --wall-scale 0.001": "beside a file as --wall",
    "paint --wall-height 3": "--wall-height",
    "paint --colours 2": "--colours: found '2' (no effect), allowed: only beside a PNG or JPEG",
    "paint --image used/a.svg --ink dark": "--ink",
    "paint --threshold global": "--threshold",
    "paint --line-art area": "--line-art",
    "paint --export-world 5": "--export-world",
    "paint --export": "--export: found 'nothing', allowed: none, or",
    "paint --export svg": "--export",
    "paint --export csv --export-world 64": "--export-world",
    "paint --record": "--record: found 'nothing', allowed: none, or",
    "paint --record 64": "--record: found '64', allowed: below --worlds (64)",
    "paint --record 1 2 1": "--record",
    "paint --record -1": "--record",
    "paint --record 1 two": "--record",
    "paint --no-halting --theta 0.3": "--theta",
    "paint --no-low-speed --low-speed-scale 2": "--low-speed-scale",
    "paint --chosen theta": "--chosen",
    "paint --config chosen.json": "chosen: found 'wall'",
    "paint --config unlisted.json": "chosen: found '7'",
    "paint --config nowhere.json": "nowhere.json",
    "paint --config text.txt": "text.txt",
    "paint --config other.json": "bench",
    "paint --config strange.json": "colour",
    "paint --config wrong.json": "--worlds",
    "paint --config newer.json": "written by jaxpaint 99.0",
    "paint --config broken.json": "not JSON",
    "reproduce --config nameless.json": "no name",
    "paint --out used": "used",
    "paint --out text.txt": "text.txt",
    "paint --out text.txt/below": "--out",
    "paint extra": "extra",
    "bench everything": "NAME",
    "reproduce everything": "NAME",
    "reproduce": "NAME",
    "reproduce sensor-noise": "--data: found 'none', allowed: the folder with clouds/ and rgbd/",
    "reproduce sensor-noise --data nowhere": "nowhere",
    "reproduce sensor-noise --data text.txt": "an existing folder",
    "reproduce sensor-noise --data used": "clouds/pcl_capture0001.pcd",
    "reproduce motion --data used": "no effect",
    "compare": "A: found too few values",
    "compare used": "B: found too few values",
    "compare nowhere used": "nowhere",
    "compare used used": "A: found",
    "compare text.txt other.json": "not JSON",
    "compare wrong.json other.json": "a run of 'paint'",
    "compare strange.json list.json": "B: found",
    "compare other.json other.json other.json": "other.json",
    "view": "RUN: found too few values",
    "view nowhere": "nowhere",
    "view used": "used",
    "view text.txt": "not JSON",
    "view other.json": "a run of 'bench', allowed: a run of 'jaxpaint paint'",
    "view strange.json": "colour",
    "view wrong.json": "--worlds",
    "view unlisted.json": "chosen: found '7'",
    "view wrong.json --frames 0": "--frames",
    "view wrong.json --world -1": "--world",
    "view wrong.json --size 640": "--size",
    "view wrong.json --size 640 10": "--size",
    "view wrong.json --frames 1000 --size 4096 4096": "pixels in all",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_usage_is_one_line_and_status_2(line, capsys, tmp_path, pipeline):
    (tmp_path / "text.txt").write_text("words")
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "mine").write_text("precious")
    (tmp_path / "used" / "a.svg").touch()
    (tmp_path / "other.json").write_text('{"command": "bench", "config": {}}')
    (tmp_path / "strange.json").write_text('{"command": "paint", "config": {"colour": 1}}')
    (tmp_path / "wrong.json").write_text('{"command": "paint", "config": {"worlds": [1]}}')
    newer = {"command": "paint", "config": {"colour": 1}, "versions": {"jaxpaint": "99.0"}}
    (tmp_path / "newer.json").write_text(json.dumps(newer))
    (tmp_path / "broken.json").write_text('{"command": "paint", "config": {')
    (tmp_path / "list.json").write_text("[1]")
    for name, chosen in (("chosen", ["theta", "wall"]), ("unlisted", 7)):
        summary = {"command": "paint", "config": {}, "chosen": chosen}
        (tmp_path / f"{name}.json").write_text(json.dumps(summary))
    (tmp_path / "nameless.json").write_text('{"command": "reproduce", "config": {}}')
    before = sorted(tmp_path.rglob("*"))
    assert main(line.split()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert BAD[line] in said.err
    assert "Traceback" not in said.err
    assert "allowed" in said.err
    assert sorted(tmp_path.rglob("*")) == before
    assert pipeline.options == []
