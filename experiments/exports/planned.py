"""Which world's plan is exported, and why one is not."""

from collections.abc import Sequence

import numpy as np

from sims.painting.job import Job
from sims.painting.joint_plan import JointTrajectory, planned_joint_trajectory
from sims.painting.mission import Mission
from sims.status import Status

# A robot must not be sent where the run says that it cannot go.
_REFUSED = (Status.UNREACHABLE, Status.INFEASIBLE, Status.DIVERGED)


def planned(job: Job, missions: Sequence[Mission], world: int) -> tuple[JointTrajectory | None, str]:
    """The planned trajectory of a world of the run whose groups are `missions`; or none, and why in words."""
    ends = np.cumsum([len(mission.status) for mission in missions])
    group = int(np.searchsorted(ends, world, side="right"))
    if group == len(missions):
        return None, f"no trajectory exported: world {world} was not finished"
    row = world - int(ends[group]) + len(missions[group].status)
    status = Status(int(missions[group].status[row]))
    if status in _REFUSED:
        return None, f"no trajectory exported: world {world} is {status.label} ({status.meaning})"
    return planned_joint_trajectory(job, missions[group], row, number=world), ""
