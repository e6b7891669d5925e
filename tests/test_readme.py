"""The example in the README runs as it stands there."""

import re
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]


def test_the_library_example_solves_its_problems():
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    names: dict = {}
    exec(compile(example, "README.md", "exec"), names)
    speeds = np.asarray(names["speeds"])
    reached = np.einsum("nij,nj->ni", names["jacobians"], speeds)
    within = np.abs(speeds).max(axis=1) < 0.9
    assert within.mean() > 0.9
    np.testing.assert_allclose(reached[within], np.broadcast_to(names["twist"], (within.sum(), 6)), atol=1e-4)


def test_every_file_that_the_documents_point_to_is_there():
    for document in ("README.md", "CONTRIBUTING.md"):
        text = (ROOT / document).read_text()
        targets = re.findall(r"\]\(([^)#:]+)\)", text) + re.findall(r"`((?:sims|experiments)/[\w/.]+)`", text)
        assert targets
        assert [target for target in targets if not (ROOT / target).exists()] == []
