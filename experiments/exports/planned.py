"""Which world's plan is exported, and why one is not."""

import numpy as np
from jaxtyping import Int

from sims.painting.job import Job
from sims.painting.joint_plan import JointTrajectory, planned_joint_trajectory
from sims.painting.mission import Mission
from sims.status import Status

# A robot must not be sent where the run says that it cannot go.
_REFUSED = (Status.UNREACHABLE, Status.INFEASIBLE, Status.DIVERGED)


def planned(
    job: Job, index: Int[np.ndarray, " worlds"], mission: Mission, world: int
) -> tuple[JointTrajectory | None, str]:
    """The planned trajectory of a world of the run, which is one of a group; or none, and why in words.

    index: the group's worlds.
    """
    row = int(np.searchsorted(index, world))
    status = Status(int(mission.status[row]))
    if status in _REFUSED:
        return None, f"no trajectory exported: world {world} is {status.label} ({status.meaning})"
    return planned_joint_trajectory(job, mission, row, number=world), ""


def not_finished(world: int) -> str:
    """Why nothing is exported of a world that never ran to its end."""
    return f"no trajectory exported: world {world} was not finished"
