"""How a world can end: every world has exactly one status, and every status is counted."""

from enum import IntEnum


class Status(IntEnum):
    """The end of one run; only `OK` is a success."""

    OK = 0
    UNREACHABLE = 1
    INFEASIBLE = 2
    NOT_CONVERGED = 3
    DIVERGED = 4

    @property
    def meaning(self) -> str:
        """One line for a person."""
        return _MEANINGS[self]

    @property
    def label(self) -> str:
        """The name in files and tables."""
        return self.name.lower()


_MEANINGS = {
    Status.OK: "every mapped pen-down point executed, 95 % of pen-down time within 30 mm of the plan",
    Status.UNREACHABLE: "a viewpoint, the canvas or the path lies outside of what base and arm can reach",
    Status.INFEASIBLE: "the controller found no velocity within the limits that follows the path",
    Status.NOT_CONVERGED: "the run ended before every mapped point was executed, or strayed from the plan",
    Status.DIVERGED: "a state became non-finite or left the workspace",
}
