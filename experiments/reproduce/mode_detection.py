"""Mode detection, S1-(5) to (7), on held-out lists of poses: how often the right controller is chosen."""

import dataclasses
import math
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from experiments.report.style import EXCESS, INK, PAINT, look, new_figure
from experiments.reproduce.mode_sets import MOST, PoseList, draw_list
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from jaxpaint.decisions.modes import ModeSettings, Statistic, decide
from jaxpaint.decisions.thresholds import Thresholds, default_thresholds

NAME = "mode-detection"
LISTS = 400
FIRST_HELD_OUT = 200_000
"""Lists from this seed on were not looked at when the defaults were chosen."""
_ROOMS = (64, 512, MOST)
"""Lengths that lists are padded to: one program each."""


@dataclasses.dataclass(frozen=True)
class Variant:
    """A statistic, and whether the variance in all directions is added that `decide` speaks of."""

    name: str
    statistic: Statistic
    tolerance: bool = True
    gap: bool = True

    @property
    def settings(self) -> ModeSettings:
        kept = ModeSettings()
        return ModeSettings(
            tolerance=kept.tolerance if self.tolerance else jnp.zeros(()),
            gap=kept.gap if self.gap else jnp.zeros(()),
        )


VARIANTS = (
    Variant("ours", "deviation"),
    Variant("range PC_1 - PC_n", "range"),
    Variant("without gap", "deviation", gap=False),
    Variant("without tolerance", "deviation", tolerance=False),
    Variant("deviation over its maximum alone", "deviation", tolerance=False, gap=False),
    Variant("literal", "literal"),
)


def run(
    settings: ReproduceSettings | None = None, lists: int = LISTS, variants: tuple[Variant, ...] = VARIANTS
) -> ReproduceResult:
    """Accuracy of every variant, over all lists and by kind; the paper publishes none."""
    first = FIRST_HELD_OUT + 2 * lists * (settings or ReproduceSettings()).seed
    drawn = [draw_list(seed) for seed in range(first, first + lists)]
    is_path = np.array([one.is_path for one in drawn])
    rows, values = [], {}
    for variant in variants:
        chosen, values[variant.name] = evaluate(drawn, variant)
        right = chosen == is_path
        for what, among in (("all", is_path | True), ("waypoints", ~is_path), ("strokes", is_path)):
            low, high = wilson(int(right[among].sum()), int(among.sum()))
            rows.append(Row(f"right, {what}", variant.name, None, float(right[among].mean()), low, high))
    return ReproduceResult.of(rows, {"statistic": _figure(values, is_path, default_thresholds())})


def evaluate(lists: list[PoseList], variant: Variant) -> tuple[np.ndarray, np.ndarray]:
    """Which lists go to the whole-body controller, and their statistic."""
    thresholds, settings = default_thresholds(), variant.settings
    chosen = [_decide(*_padded(one), thresholds, settings, statistic=variant.statistic) for one in lists]
    whole_body, statistic = np.asarray(jax.device_get(chosen)).T
    return whole_body > 0.5, statistic


@partial(jax.jit, static_argnames="statistic")
def _decide(
    position, rotation, mask, thresholds: Thresholds, settings: ModeSettings, *, statistic: Statistic
):
    decision = decide(position, rotation, mask, thresholds, settings, statistic=statistic)
    return decision.whole_body, decision.statistic


def _padded(one: PoseList) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    number = len(one.position)
    more = next(room for room in _ROOMS if room >= number) - number
    position = np.pad(one.position, ((0, more), (0, 0)))
    rotation = np.concatenate([one.rotation, np.tile(np.eye(3), (more, 1, 1))])
    return position.astype(float), rotation, np.arange(number + more) < number


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson's score interval)."""
    z = 1.959964
    share, spread = hits / trials, z * z / trials
    half = z * math.sqrt(share * (1 - share) / trials + spread / (4 * trials))
    return (share + spread / 2 - half) / (1 + spread), (share + spread / 2 + half) / (1 + spread)


def _figure(values: dict[str, np.ndarray], is_path: np.ndarray, thresholds: Thresholds) -> Figure:
    """How the statistic falls for both kinds, and the band of S1."""
    band = float(thresholds.variance_lower), float(thresholds.variance_upper)
    with look():
        across = min(3, len(values))
        down = -(-len(values) // across)
        figure = new_figure(1 + 2.25 * down)
        axes = figure.subplots(down, across, sharex=True, squeeze=False)
        for axis, (name, value) in zip(axes.flat, values.items(), strict=False):
            axis.axvspan(*band, color=INK, alpha=0.08, linewidth=0)
            for kind, colour, label in ((~is_path, EXCESS, "waypoints"), (is_path, PAINT, "strokes")):
                axis.hist(value[kind], bins=np.linspace(0, 1, 51), color=colour, alpha=0.75, label=label)
            axis.set_title(name)
        axes[0, 0].legend()
        for axis in axes[-1]:
            axis.set_xlabel("statistic, S1-(7); the band is grey")
        for axis in axes[:, 0]:
            axis.set_ylabel("lists")
    return figure
