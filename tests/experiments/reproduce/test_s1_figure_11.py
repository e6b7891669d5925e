import io

import numpy as np

from experiments.report.style import to_png
from experiments.reproduce.s1_figure_11 import run


def test_hits_are_within_a_millimetre_and_a_degree():
    result = run(variants=("ours",))
    table = {row["name"]: row["ours"] for row in result.table if row["variant"] == "ours"}
    walls = ("flat", "corner", "cylinder")
    assert {name.rpartition(", ")[2] for name in table} == set(walls)
    for wall in walls:
        assert table[f"largest distance of a hit from the surface [m], {wall}"] <= 1e-3
        assert table[f"largest lean of the brush from the normal [deg], {wall}"] <= 1.0
        assert table[f"rays left out [1], {wall}"] <= (0.03 if wall == "corner" else 0.0)
    picture = to_png(result.figures["trajectories"])
    assert picture.startswith(b"\x89PNG") and len(io.BytesIO(picture).getvalue()) > 10_000
    assert np.unique([len(axis.collections) for axis in result.figures["trajectories"].axes]).tolist() == [1]
