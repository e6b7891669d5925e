"""The files of one view, written once."""

from pathlib import Path

import pytest

from experiments.viewing import read_recorded, write_view


@pytest.fixture(scope="session")
def view(recorded_run, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("view")
    recorded = read_recorded(recorded_run, "RUN")
    write_view(recorded, recorded.motion(3), folder, 4 / 3)
    return folder
