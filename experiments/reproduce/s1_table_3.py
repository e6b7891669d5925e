"""S1 table III: tracking of a curve in the real robot: 46 mm in all."""

from experiments.reproduce.result import ReproduceResult, ReproduceSettings
from experiments.reproduce.s1_tracking import WORLDS, TrackingTable, run_table

NAME = "s1-table-3"
TABLE = TrackingTable(preset="s1-real", published=0.046, theta=0.4)


def run(settings: ReproduceSettings | None = None, worlds: int = WORLDS) -> ReproduceResult:
    """Of the paper only the total is known: its values by axis are not in our copy."""
    return run_table(TABLE, (settings or ReproduceSettings()).seed, worlds)
