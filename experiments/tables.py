"""Short tables of results that a person reads."""

import dataclasses
import math
import sys
from collections.abc import Sequence

Cell = str | int | float | None


@dataclasses.dataclass(frozen=True)
class Table:
    """Rows of cells under named columns; numbers are right-aligned, None is a missing figure."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"rows: found {len(row)} cells in {row}, allowed: {len(self.columns)}")


def in_words(cell: Cell) -> str:
    """A cell as text: three significant digits, a dash where there is no figure."""
    if cell is None:
        return "–"
    if isinstance(cell, str | bool | int):
        return str(cell)
    if not math.isfinite(cell):
        return "–"
    if cell and not 1e-4 <= abs(cell) < 1e6:
        return f"{cell:.2e}"
    digits = max(0, 2 - math.floor(math.log10(abs(cell)))) if cell else 0
    return f"{cell:.{digits}f}"


def quantity(value: float | None, factor: float, unit: str) -> str:
    """A value [SI] in the unit that a person reads, `factor` of which make one in SI; a dash for None."""
    if value is None or not math.isfinite(value):
        return in_words(None)
    words = in_words(float(value) * factor)
    return f"{words.rstrip('0').rstrip('.') if '.' in words and 'e' not in words else words} {unit}"


def is_figure(table: Table, column: int) -> bool:
    """Does this column hold numbers (and is read best from the right)?"""
    cells = [row[column] for row in table.rows if row[column] is not None]
    return bool(cells) and all(isinstance(cell, int | float) for cell in cells)


def as_text(table: Table) -> str:
    """Aligned plain text, for files and pipes."""
    grid = [list(table.columns), *[[in_words(cell) for cell in row] for row in table.rows]]
    widths = [max(len(row[column]) for row in grid) for column in range(len(table.columns))]
    right = [is_figure(table, column) for column in range(len(table.columns))]
    lines = [table.title] if table.title else []
    for row in grid:
        cells = [_aligned(cell, width, end) for cell, width, end in zip(row, widths, right, strict=True)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def show(tables: Sequence[Table]) -> None:
    """Tables on standard output: drawn for a terminal, plain otherwise."""
    if not sys.stdout.isatty():
        for table in tables:
            print(as_text(table), end="\n\n")
        return
    from rich.console import Console

    console = Console()
    for table in tables:
        console.print(_drawn(table))


def _aligned(cell: str, width: int, right: bool) -> str:
    return cell.rjust(width) if right else cell.ljust(width)


def _drawn(table: Table):
    from rich import box
    from rich.table import Table as Drawn
    from rich.text import Text

    drawn = Drawn(title=table.title or None, title_justify="left", box=box.SIMPLE_HEAD)
    for column, name in enumerate(table.columns):
        drawn.add_column(Text(name), justify="right" if is_figure(table, column) else "left")
    for row in table.rows:
        drawn.add_row(*[Text(in_words(cell)) for cell in row])
    return drawn
