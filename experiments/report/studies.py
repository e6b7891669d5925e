"""The report of reproduced tables and figures: published against ours."""

from collections.abc import Mapping
from typing import Any

from experiments.report.page import Figure, Page, Section
from experiments.report.settings import settings
from experiments.report.style import look, to_png
from experiments.reproduce import ReproduceResult
from experiments.tables import Table

COLUMNS = ("quantity", "variant", "published", "ours", "95 % from", "to")


def build_page(results: Mapping[str, ReproduceResult], summary: Mapping[str, Any]) -> Page:
    """A section for every table or figure, with its pictures before its numbers."""
    sections = tuple(_section(name, result) for name, result in results.items())
    names = ", ".join(results)
    return Page(f"jaxpaint reproduce, seed {summary['seed']}", names, sections=(*sections, settings(summary)))


def result_table(name: str, result: ReproduceResult) -> Table:
    """The rows of one result; a dash where the paper's value is not known or nothing is random."""
    keys = ("name", "variant", "published", "ours", "low", "high")
    return Table(COLUMNS, tuple(tuple(row[key] for key in keys) for row in result.table), name)


def _section(name: str, result: ReproduceResult) -> Section:
    with look():
        pictures = tuple(
            Figure(to_png(figure), f"{name}: {title}") for title, figure in result.figures.items()
        )
    return Section(name, "", pictures, (result_table("", result),))
