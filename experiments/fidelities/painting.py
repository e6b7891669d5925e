"""A minute of painting on wheels: does it hold, and how far is the base from where it should be?"""

from typing import cast

import numpy as np

from experiments.tracking.curves import line
from experiments.tracking.follow import drive_study
from experiments.tracking.study import study_of
from sims.rollout import RECORD_EVERY
from sims.wheeled import Wheeled, tread_depths

# A line that takes a minute [m], [m/s].
_LENGTH, _SPEED = 1.8, 0.03


def painted_minute(worlds: int, seed: int) -> dict[str, float]:
    """Shares of worlds, and largest and median distances."""
    study = study_of(line(_LENGTH), fidelity="wheeled", speed=_SPEED, seed=seed)
    driven = drive_study(study, worlds)
    record = driven.record
    live = np.asarray(record.live)
    rest = np.linalg.norm(record.base[..., :2] - record.odometry[..., :2], axis=-1)
    believed = np.linalg.norm(record.base[..., :2] - record.believed[..., :2], axis=-1)
    fidelity = cast(Wheeled, study.job.fidelity)
    depth = tread_depths(fidelity.engine.rolling, np.asarray(record.tilt)).min(axis=-1)
    return {
        "simulated [s]": float(live.sum(axis=1).mean() * float(study.job.dt) * RECORD_EVERY),
        "worlds with a number that is not finite [1]": float(np.asarray(driven.diverged).sum()),
        "base off odometry at the end, median [m]": float(np.median(rest[:, -1])),
        "base off what the robot believes, median [m]": float(np.median(believed[live])),
        "least depth of any wheel in the floor [m]": float(depth[live].min()),
    }
