"""One line of `jaxpaint bench`: our rate beside a peer's, both measured in the same run."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from experiments.tables import Table


@dataclasses.dataclass(frozen=True)
class Bench:
    """What a benchmark gives: rows, and what else there is to see. summary: more keys of summary.json, under
    the benchmark's name. figures: by name.
    """

    rows: list["BenchRow"]
    tables: tuple[Table, ...] = ()
    figures: Mapping[str, Figure] = dataclasses.field(default_factory=dict)
    summary: Mapping[str, Any] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True)
class BenchRow:
    """`ours` and `peer` are rates [1/s] at the same work: only their ratio travels between machines."""

    name: str
    ours: float
    peer: float
    peer_name: str

    def __post_init__(self) -> None:
        for field in ("ours", "peer"):
            rate = getattr(self, field)
            if not (math.isfinite(rate) and rate > 0):
                raise ValueError(
                    f"{field}: a rate is finite and above 0 [1/s], found {rate}, in row {self.name!r}"
                )

    @property
    def ratio(self) -> float:
        """How many times faster ours is."""
        return self.ours / self.peer

    def to_dict(self) -> dict[str, str | float]:
        """The row as it stands in summary.json."""
        return {**dataclasses.asdict(self), "ratio": self.ratio}
