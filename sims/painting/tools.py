"""Which tool the robot holds while it paints: one for each colour."""

import numpy as np
from jaxtyping import Bool, Float, Int

from sims.painting.job import Job
from sims.painting.path import Painting
from sims.rollout import RECORD_EVERY, Record


def colour_count(job: Job) -> int:
    """How many colours the strokes have."""
    return 1 if job.colour is None else int(np.max(np.asarray(job.colour), initial=0)) + 1


def in_hand(
    job: Job,
    painting: Painting,
    clock: Float[np.ndarray, "worlds time"],
    whole_body: Bool[np.ndarray, " worlds"],
    ideal: Record | None,
) -> Int[np.ndarray, "worlds time"] | None:
    """The colour in hand at each record, None where there is but one.

    clock: of the plan that each world followed [s]. whole_body: whose plan is the brush path itself; the
    others follow joints recorded in the `ideal` run, whose own record knows the path's clock.
    """
    if colour_count(job) == 1:
        return None
    if ideal is not None:
        known = np.asarray(ideal.clock)
        row = np.clip((clock / (float(job.dt) * RECORD_EVERY)).astype(int), 0, known.shape[1] - 1)
        clock = np.where(whole_body[:, None], clock, np.take_along_axis(known, row, axis=1))
    return painting.colour(clock)
