"""Tables as a person reads them."""

import math

import pytest

from experiments.tables import Table, as_text, in_words, quantity, show


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        (None, "–"),
        (math.nan, "–"),
        (math.inf, "–"),
        (0.0, "0"),
        (0.01234, "0.0123"),
        (12.345, "12.3"),
        (-4567.8, "-4568"),
        (0.98765, "0.988"),
        (1.2e-7, "1.20e-07"),
        (64, "64"),
        ("ok", "ok"),
    ],
)
def test_a_cell_in_words(cell, words):
    assert in_words(cell) == words


def test_quantities_carry_their_unit():
    assert quantity(0.0037, 1e3, "mm") == "3.7 mm"
    assert quantity(0.5, 100, "%") == "50 %"
    assert quantity(100.0, 1, "s") == "100 s"
    assert quantity(None, 1e3, "mm") == "–"


def test_plain_text_is_aligned(capsys):
    table = Table(("name", "count"), (("ok", 64), ("diverged", 3), ("none", None)), title="Worlds")
    assert as_text(table).splitlines() == [
        "Worlds",
        "name      count",
        "ok           64",
        "diverged      3",
        "none          –",
    ]
    show([table])
    assert capsys.readouterr().out == as_text(table) + "\n\n"


def test_a_row_of_the_wrong_length_is_refused():
    with pytest.raises(ValueError, match="rows"):
        Table(("a", "b"), ((1,),))
