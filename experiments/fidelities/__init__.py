"""How the three fidelities move when they are told the same."""

from experiments.fidelities.follow import Followed, follow
from experiments.fidelities.motions import MOTIONS, Motion

__all__ = ["MOTIONS", "Followed", "Motion", "follow"]
