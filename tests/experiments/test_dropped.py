"""What was left out, in words."""

import numpy as np

from experiments.dropped import cause_counts, dropped_words, stroke_names
from jaxpaint.mapping.mapped import Cause


def test_strokes_over_a_hole_are_named():
    stroke = np.repeat(np.arange(4), 5)
    status = np.zeros((3, 20), int)
    status[:, 7:13] = Cause.MISS  # the second and the third
    status[0, 0] = Cause.SHARP  # in one world of three: not the picture's fault
    assert dropped_words(stroke, cause_counts(status)) == [
        "left out, over a hole or the wall's rim: 6 of 20 points, in strokes 2-3"
    ]


def test_each_reason_has_a_line():
    stroke = np.arange(3)
    status = np.array([[Cause.HIT, Cause.STEEP, Cause.CLEARANCE]])
    lines = dropped_words(stroke, cause_counts(status))
    assert ["too steep" in line for line in lines] == [True, False]
    assert lines[1].endswith("1 of 3 points, in stroke 3")


def test_nothing_left_out_says_nothing():
    assert dropped_words(np.zeros(4, int), cause_counts(np.zeros((2, 4), int))) == []


def test_many_strokes_are_counted_not_listed():
    assert stroke_names([3]) == "stroke 3"
    assert stroke_names([1, 2, 3, 9]) == "strokes 1-3, 9"
    assert stroke_names(range(0, 60, 2)).endswith("and 18 more")
