"""Fidelity `wheeled`: a free base on steered, driven wheels in contact with the floor, by MJX."""

from sims.wheeled.engine import Motion, WheeledEngine
from sims.wheeled.fidelity import Servos, Wheeled, wheeled
from sims.wheeled.floors import Bump, Flat, Floor, Ramp
from sims.wheeled.model import wheeled_model
from sims.wheeled.parameters import WheeledPhysics, wheeled_physics
from sims.wheeled.rest import Rest, at_rest, tread_depths

__all__ = [
    "Bump",
    "Flat",
    "Floor",
    "Motion",
    "Ramp",
    "Rest",
    "Servos",
    "Wheeled",
    "WheeledEngine",
    "WheeledPhysics",
    "at_rest",
    "tread_depths",
    "wheeled",
    "wheeled_model",
    "wheeled_physics",
]
