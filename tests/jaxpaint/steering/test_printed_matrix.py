"""S1-(9) as printed is no wheel: under no choice of signs are both its rows the no-slip constraints of one.

Printed, times r and l:

    row 1    r theta' = C v_x - S v_y + (a S - b C) w = C (v_x - b w) - S (v_y - a w)
    row 2    l phi'   = S v_x + C v_y + (l + b S - a C) w = S (v_x + b w) + C (v_y - a w) + l w

Both rows give the axis the velocity v_y - a w along y, but along x row 1 gives it v_x - b w, row 2 v_x + b w.
A sign that flips one flips the other.
"""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

R = 0.1
RNG = np.random.default_rng(0)
# Matrices that agree at random places, offsets and angles agree.
PLACES = [tuple(RNG.uniform((0.1, 0.1, 0.02, -3), (0.6, 0.6, 0.15, 3))) for _ in range(5)]


def printed(a, b, link, phi):
    """S1-(9): theta' and phi' for unit twists. [2, 3]"""
    c, s = np.cos(phi), np.sin(phi)
    rolling = [link * c, -link * s, a * link * s - b * link * c]
    turning = [R * s, R * c, link * R + b * R * s - a * R * c]
    return np.array([rolling, turning]) / (R * link)


def no_slip(a, b, link, phi):
    """The same matrix for a wheel that rolls and does not slip, its contact `link` along its direction."""
    along, across = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    axis = np.array([[1, 0, -b], [0, 1, a]])  # velocity of the steering axis for unit twists
    return np.stack([along @ axis / R, -across @ axis / link - [0, 0, 1]])


class Convention(NamedTuple):
    """Signs of the twist (v_x, v_y, w), of the wheel (theta, phi) and of the place (a, b, l); at which
    quarter turn phi is 0; whether x and y are exchanged in the twist, and in the place.
    """

    twist: tuple[int, int, int]
    wheel: tuple[int, int]
    place: tuple[int, int, int]
    quarter: int
    twist_swapped: bool
    place_swapped: bool

    def write(self, matrix, a, b, link, phi):
        """A matrix in this convention's quantities."""
        places = [b, a] if self.place_swapped else [a, b]
        turned = self.wheel[1] * phi + self.quarter * np.pi / 2
        found = matrix(*np.multiply(self.place, [*places, link]), turned) * np.array(self.twist)
        found = found[:, [1, 0, 2]] if self.twist_swapped else found
        return found * np.array(self.wheel)[:, None]

    def is_a_frame(self):
        """Whether twist and place are counted in one and the same frame, be it left-handed."""
        left_handed = self.twist[0] * self.twist[1] * (-1 if self.twist_swapped else 1)
        same = self.twist_swapped == self.place_swapped and self.twist[:2] == self.place[:2]
        return same and self.twist[2] == left_handed


CONVENTIONS = [
    Convention(signs[:3], signs[3:5], signs[5:], *rest)
    for signs in itertools.product([1, -1], repeat=8)
    for rest in itertools.product(range(4), [False, True], [False, True])
]


def agreeing(target):
    """Conventions in which row 1 of a wheel without slip is that of `target`, and those in which row 2 is."""
    fits = np.array(
        [
            np.max([np.abs(c.write(no_slip, *p) - target(*p)).max(1) for p in PLACES], axis=0) < 1e-9
            for c in CONVENTIONS
        ]
    )
    return [{c for c, fit in zip(CONVENTIONS, column, strict=True) if fit} for column in fits.T]


@pytest.fixture(scope="module")
def rows():
    return agreeing(printed)


def test_no_signs_make_both_printed_rows_one_wheel(rows):
    assert len(CONVENTIONS) == 4096
    assert not rows[0] & rows[1]


def test_each_row_alone_is_a_wheel_under_some_signs(rows):
    """Row 1, say, with only v_y flipped; row 2 with phi, a and b flipped. As they stand, neither is."""
    straight = Convention((1, 1, 1), (1, 1), (1, 1, 1), 0, False, False)
    assert straight._replace(twist=(1, -1, 1)) in rows[0]
    assert straight._replace(wheel=(1, -1), place=(-1, -1, 1)) in rows[1]
    assert straight not in rows[0] | rows[1]
    assert (len(rows[0]), len(rows[1])) == (64, 32)


def test_neither_row_is_a_wheel_in_any_one_frame(rows):
    """Places and velocities flipped together are another frame, in which wheels look as before."""
    assert sum(c.is_a_frame() for c in CONVENTIONS) == 256
    assert not any(c.is_a_frame() for c in rows[0] | rows[1])


def test_with_one_sign_mended_both_rows_are_one_wheel():
    """b flipped in row 2: so the search would have found a wheel, and b is where the rows part."""

    def mended(a, b, link, phi):
        return np.stack([printed(a, b, link, phi)[0], printed(a, -b, link, phi)[1]])

    first, second = agreeing(mended)
    assert first & second


def test_the_printed_rows_have_the_axis_move_two_ways_along_x():
    """A pure turn: row 1 has the axis move with (-b, -a) w, row 2 with (b, -a) w."""
    for a, b, link, phi in PLACES:
        rolling, turning = printed(a, b, link, phi)[:, 2] * [R, link] - [0, link]
        c, s = np.cos(phi), np.sin(phi)
        np.testing.assert_allclose(rolling, np.dot([c, -s], [-b, -a]), atol=1e-12)
        np.testing.assert_allclose(turning, np.dot([s, c], [b, -a]), atol=1e-12)
