"""The film strip, drawn by the script that goes with a view, in a process that has OpenGL."""

import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from experiments.viewing.files import SCRIPT


def draw_film(
    folder: Path, path: Path, frames: int, size: tuple[int, int], environment: Mapping[str, str]
) -> None:
    """Draws the view in `folder` to a PNG of so many pictures of width x height. Raises RuntimeError."""
    words = ["--film", str(path), "--frames", str(frames), "--size", *map(str, size)]
    with tempfile.TemporaryDirectory() as elsewhere:  # MuJoCo writes its log where it runs
        done = subprocess.run(
            [sys.executable, str(folder / SCRIPT), *words],
            env=environment,
            cwd=elsewhere,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        raise RuntimeError(f"{path.name} is not drawn: {said[-1]}")
