"""The lock: everything that `make` installs, by version and hash, from no place in particular."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def name_of(requirement: str) -> str:
    """The normalised name in a requirement such as `mujoco-mjx>=3.17` or `jax[cuda12]`."""
    return re.split(r"[^\w.-]", requirement.strip())[0].replace("_", "-").lower()


def direct_requirements() -> list[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras = project["project"]["optional-dependencies"]
    lines = (
        project["project"]["dependencies"]
        + extras["bench"]
        + extras["dev"]
        + project["build-system"]["requires"]
    )
    return sorted({name_of(line) for line in lines})


@pytest.fixture(scope="module")
def locked() -> dict[str, str]:
    """From the name to the whole entry: version, marker, hashes."""
    text = re.sub(r"(?m)^\s*#.*\n", "", (ROOT / "requirements.lock").read_text())
    entries = re.split(r"\n(?=\S)", text.strip())
    return {name_of(entry): entry for entry in entries}


@pytest.mark.parametrize("name", direct_requirements())
def test_every_direct_requirement_is_locked(name: str, locked: dict[str, str]):
    assert name in locked


def test_every_entry_has_a_version_and_hashes_and_nothing_else(locked: dict[str, str]):
    entry = re.compile(r"[a-z0-9.-]+==[\w.+]+( ; [^\\]+)?( \\\n    --hash=sha256:[0-9a-f]{64})+")
    assert len(locked) > 40
    assert [name for name, text in locked.items() if not entry.fullmatch(text)] == []
