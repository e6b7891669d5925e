"""One painting run in many worlds: scan, map, decide, move, lay paint, and say how it went."""

from sims.painting.job import Job
from sims.painting.mission import Mission, run_mission

__all__ = ["Job", "Mission", "run_mission"]
