"""Which tool the robot holds while it paints: one for each colour."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from jaxpaint.compiling import one_by_one
from jaxpaint.mapping.timeline import colour_at
from sims.painting.job import Job
from sims.painting.path import Painting
from sims.rollout import RECORD_EVERY, Record

_COLOUR = one_by_one(colour_at, in_axes=(0, 0))


def in_hand(
    job: Job,
    painting: Painting,
    clock: Float[np.ndarray, "worlds time"],
    whole_body: Bool[np.ndarray, " worlds"],
    ideal: Record | None,
) -> Int[np.ndarray, "worlds time"] | None:
    """The colour in hand at each record, None where there is but one.

    clock: of the plan that each world followed [s]. whole_body: whose plan is the brush path itself; the
    others follow joints recorded in the `ideal` run, whose own record knows the path's clock. Raises
    ValueError where a stroke has a colour that the job does not know of.
    """
    last = 0 if job.colour is None else int(np.max(np.asarray(job.colour), initial=0))
    if last >= job.colours:
        raise ValueError(
            f"job.colour: found colour {last}, allowed: 0 to {job.colours - 1}, as job.colours says"
        )
    if job.colours == 1:
        return None
    if ideal is not None:
        known = np.asarray(ideal.clock)
        row = np.clip((clock / (float(job.dt) * RECORD_EVERY)).astype(int), 0, known.shape[1] - 1)
        clock = np.where(whole_body[:, None], clock, np.take_along_axis(known, row, axis=1))
    return np.asarray(_COLOUR(painting.path, jnp.asarray(clock)))
