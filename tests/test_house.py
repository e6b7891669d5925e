"""The rules of the house: which way imports go, what a package exports, what an import does."""

import ast
import importlib
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

MAY_IMPORT = {
    "jaxpaint": {"jaxpaint"},
    "opt": {"opt", "jaxpaint"},
    "nets": {"nets", "jaxpaint"},
    "sims": {"sims", "opt", "nets", "jaxpaint"},
    "experiments": {"experiments", "sims", "opt", "nets", "jaxpaint"},
}
NAMES_OF_NO_IDEA = {"utils", "util", "helpers", "helper", "common", "misc"}
LONGEST_FILE = 350  # lines: the rule says about 300

MODULES = sorted(path for package in MAY_IMPORT for path in (ROOT / package).rglob("*.py"))
PACKAGES = [path for path in MODULES if path.name == "__init__.py"]


def dotted(path: Path) -> str:
    """The name by which a module is imported."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def as_ids(paths: list[Path]) -> list[str]:
    return [dotted(path) for path in paths]


def imported(source: str) -> set[str]:
    """Top-level names that `source` imports anywhere in it, '.' for a relative import."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or ".").split(".")[0] if node.level == 0 else ".")
    return found


def wrong_imports(package: str, source: str) -> set[str]:
    """What a module of `package` imports and may not."""
    return imported(source) & ((MAY_IMPORT.keys() | {"tests", "."}) - MAY_IMPORT[package])


@pytest.mark.parametrize("path", MODULES, ids=as_ids(MODULES))
def test_imports_go_one_way(path: Path):
    assert not wrong_imports(path.relative_to(ROOT).parts[0], path.read_text())


@pytest.mark.parametrize(
    ("package", "source", "wrong"),
    [
        ("jaxpaint", "import jax, opt.qp", {"opt"}),
        ("opt", "def f():\n    from nets.agn import refine", {"nets"}),
        ("nets", "from sims import scenes as jaxpaint", {"sims"}),
        ("sims", "from experiments.cli import main", {"experiments"}),
        ("sims", "from . import robots", {"."}),
        ("experiments", "from tests.conftest import ROOT", {"tests"}),
        ("experiments", "import jaxpaint, sims, opt, nets, experiments.cli", set()),
    ],
)
def test_a_wrong_import_is_seen(package: str, source: str, wrong: set[str]):
    assert wrong_imports(package, source) == wrong


def test_every_package_of_the_house_is_looked_at():
    assert {dotted(path) for path in PACKAGES} >= MAY_IMPORT.keys()
    folders = {path.parent for path in MODULES}
    assert folders == {path.parent for path in PACKAGES}, "a folder with modules lacks its __init__.py"


@pytest.mark.parametrize("path", PACKAGES, ids=as_ids(PACKAGES))
def test_every_exported_name_resolves(path: Path):
    tree = ast.parse(path.read_text())
    assert ast.get_docstring(tree), "a package says what it is for"
    module = importlib.import_module(dotted(path))
    exported = getattr(module, "__all__", [])
    assert len(set(exported)) == len(exported)
    assert not [name for name in exported if not hasattr(module, name)]
    re_exported = {
        alias.asname or alias.name
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in MAY_IMPORT
        for alias in node.names
    }
    assert {name for name in re_exported if not name.startswith("_")} <= set(exported)


# Runs in a fresh interpreter. The number of host devices can only be set before a backend starts, so setting
# it fails if an import has started one.
PROBE = """
import importlib, json, sys
import jax
before = dict(jax.config.values)
missing = []
for name in json.load(sys.stdin):
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        missing.append(error.name)
changed = [key for key, value in jax.config.values.items() if key in before and value != before[key]]
jax.config.update("jax_num_cpu_devices", 3)
seen = {"missing": missing, "changed": changed, "devices": jax.local_device_count("cpu")}
print(json.dumps(seen), file=sys.stderr)
"""


def test_importing_every_module_does_nothing(tmp_path: Path):
    names = [dotted(path) for path in MODULES if path.name != "__main__.py"]
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("JAX_", "XLA_"))}
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", PROBE],
        input=json.dumps(names),
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=environment | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"},
        check=False,
    )
    assert run.returncode == 0, run.stderr
    seen = json.loads(run.stderr.splitlines()[-1])
    assert seen["changed"] == [], "an import changed jax's configuration"
    assert seen["devices"] == 3
    assert set(seen["missing"]) <= modules_of_extras()
    assert list(tmp_path.iterdir()) == [], "an import wrote a file"


def modules_of_extras() -> set[str]:
    """Modules that only an extra brings; without it, what needs them cannot be imported."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    wanted = [line for extra in ("bench", "tune", "cluster", "notebooks") for line in extras[extra]]
    return {re.split(r"[^\w-]", line)[0].replace("-", "_") for line in wanted}


@pytest.mark.parametrize("path", MODULES, ids=as_ids(MODULES))
def test_a_module_is_one_idea(path: Path):
    assert path.stem not in NAMES_OF_NO_IDEA
    assert path.parent.name not in NAMES_OF_NO_IDEA
    assert len(path.read_text().splitlines()) <= LONGEST_FILE


def test_nothing_names_a_package_index_or_this_machine():
    # In pieces, so that this file does not name them.
    hosts = r"py" + r"pi\.org|python" + r"hosted\.org|" + r"index-url\s*[=\s]\s*\S*:/"
    paths = r"""(?<![\w.$)}~-])/""" + r"(?:root|home|work|opt|tmp|Users)/\w"
    found = [
        f"{name}:{number}: {line.strip()[:80]}"
        for name in repository_files()
        for number, line in enumerate(text_of(ROOT / name).splitlines(), 1)
        if re.search(hosts, line) or re.search(paths, line)
    ]
    assert found == []


def repository_files() -> list[str]:
    """All that is, or by the next commit may be, in the repository."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a checkout: no .git beside the tests")
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    names = [name for name in listed.split("\0") if name and (ROOT / name).is_file()]
    assert "pyproject.toml" in names
    return names


def text_of(path: Path) -> str:
    """The text of a file, and nothing of a file that is not text."""
    data = path.read_bytes()
    return "" if b"\0" in data else data.decode(errors="replace")
