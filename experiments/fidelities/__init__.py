"""How the three fidelities move when they are told the same."""

from experiments.fidelities.follow import Followed, follow
from experiments.fidelities.motions import MOTIONS, Motion, move_length, random_moves, way_of
from experiments.fidelities.slip_fit import Moves, Walk, fit_walk, moves_of

__all__ = [
    "MOTIONS",
    "Followed",
    "Motion",
    "Moves",
    "Walk",
    "fit_walk",
    "follow",
    "move_length",
    "moves_of",
    "random_moves",
    "way_of",
]
