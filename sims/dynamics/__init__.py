"""Fidelity `dynamic`: a planar base and an arm with masses and servos, by MJX."""

from sims.dynamics.engine import Engine
from sims.dynamics.fidelity import Dynamic, Servos, dynamic
from sims.dynamics.model import planar_model
from sims.dynamics.parameters import Physics, physics_of

__all__ = ["Dynamic", "Engine", "Physics", "Servos", "dynamic", "physics_of", "planar_model"]
