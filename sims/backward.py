"""How gradients go back through a rollout: what is kept on the way, and how far back they go."""

import dataclasses
from collections.abc import Callable
from typing import Literal, TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from opt.qp import SOLUTION

State = TypeVar("State")


@dataclasses.dataclass(frozen=True)
class Backward:
    """keep: what the way there leaves for the way back. "all": every value that a step's derivative needs,
    thousands a step. "steps": the state before each control step, which is done again on the way back;
    "records": the state before each record alone. truncate: records after which gradients go no further
    back; 0 for all the way.
    """

    keep: Literal["all", "steps", "records"] = "all"
    truncate: int = 0

    def __post_init__(self) -> None:
        if self.keep not in ("all", "steps", "records"):
            raise ValueError(f"keep: found {self.keep!r}, allowed are all, steps, records")
        if self.truncate < 0:
            raise ValueError(f"truncate: found {self.truncate}, allowed are 0 and more records")

    def step(self, function: Callable) -> Callable:
        """A control step."""
        return _again(function) if self.keep == "steps" else function

    def record(self, function: Callable) -> Callable:
        """The control steps of one record."""
        return _again(function) if self.keep == "records" else function

    def cut(self, state: State, number: Int[Array, ""]) -> State:
        """The state before the record of this number, without its past where gradients end."""
        if not self.truncate:
            return state
        ends = number % self.truncate == 0

        def shortened(x):
            floating = jnp.issubdtype(x.dtype, jnp.floating)
            return jnp.where(ends, jax.lax.stop_gradient(x), x) if floating else x

        return jax.tree.map(shortened, state)


KEEP_ALL = Backward()


def _again(function: Callable) -> Callable:
    # Inside of a scan nothing can be merged with the way there: no barriers are needed.
    policy = jax.checkpoint_policies.save_only_these_names(SOLUTION)
    return jax.checkpoint(function, prevent_cse=False, policy=policy)
