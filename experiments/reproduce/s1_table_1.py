"""S1 table I: tracking of a curve in simulation: 24 mm in all."""

from experiments.reproduce.result import ReproduceResult, ReproduceSettings
from experiments.reproduce.s1_tracking import WORLDS, TrackingTable, run_table

NAME = "s1-table-1"
TABLE = TrackingTable(preset="s1-simulation", published=0.024, theta=0.4)


def run(settings: ReproduceSettings | None = None, worlds: int = WORLDS) -> ReproduceResult:
    """Of the paper only the total is known: its values by axis are not in our copy."""
    return run_table(TABLE, (settings or ReproduceSettings()).seed, worlds)
