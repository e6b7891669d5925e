"""What a reproduced table or figure gives: published against ours."""

import dataclasses
from pathlib import Path

from matplotlib.figure import Figure


@dataclasses.dataclass(frozen=True)
class ReproduceSettings:
    """seed: of whatever is drawn at random, above the seeds used in development. data: the folder of captured
    pictures and clouds, for what is measured on them.
    """

    seed: int = 0
    data: Path | None = None


@dataclasses.dataclass(frozen=True)
class Row:
    """One quantity [SI, or its unit in the name]. variant: `ours`, `literal` = as printed, or a named
    ablation or rival.

    published: None where the paper's value is not known. low, high: 95 % interval, None where nothing is
    random.
    """

    name: str
    variant: str
    published: float | None
    ours: float | None
    low: float | None = None
    high: float | None = None


@dataclasses.dataclass(frozen=True)
class ReproduceResult:
    """table: rows as dictionaries with the fields of `Row`. figures: by name, in the order to show them."""

    table: list[dict[str, str | float | None]]
    figures: dict[str, Figure]

    @classmethod
    def of(cls, rows: list[Row], figures: dict[str, Figure]) -> "ReproduceResult":
        """From rows as objects."""
        return cls([dataclasses.asdict(row) for row in rows], figures)
