"""What is kept of worlds that are finished: a few figures each, however much memory they took to run."""

import dataclasses
import io
from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float, Int

from experiments.dropped import cause_counts
from sims.painting.mission import Mission
from sims.scoring import WorldScore


@dataclasses.dataclass(frozen=True, eq=False)
class Finished:
    """Some worlds of a run, in the order of their indices `world`.

    scores: by the names of `WorldScore`. steps: live control steps of the execution. diverged_at: control
    step at which a number stopped being finite, -1 for none. down, travel: length of the path with the pen
    down and up [m]. whole_body: whether that controller was chosen for the scan, and for the strokes.
    met: in how many of these worlds each point of the picture met each `Cause`. executed_s: wall time of
    the execution.
    """

    world: Int[np.ndarray, " worlds"]
    scores: dict[str, np.ndarray]
    steps: Int[np.ndarray, " worlds"]
    diverged_at: Int[np.ndarray, " worlds"]
    down: Float[np.ndarray, " worlds"]
    travel: Float[np.ndarray, " worlds"]
    whole_body: Bool[np.ndarray, "worlds 2"]
    met: Int[np.ndarray, "causes points"]
    executed_s: float

    @classmethod
    def of(cls, index: Int[np.ndarray, " worlds"], mission: Mission, rows: Sequence[WorldScore]) -> Self:
        """The group of those indices, once it is scored."""
        path, state = mission.painting.path, mission.driven.state
        return cls(
            world=np.asarray(index),
            scores={field.name: np.array([getattr(row, field.name) for row in rows]) for field in _FIELDS},
            steps=np.asarray(state.steps),
            diverged_at=np.asarray(state.diverged_at),
            down=np.array(path.down),
            travel=np.array(path.travel),
            whole_body=np.stack([mission.modes.scan, mission.modes.paint], axis=1),
            met=cause_counts(np.asarray(path.status)),
            executed_s=mission.executed_s,
        )

    @property
    def rows(self) -> list[WorldScore]:
        """The scores, world by world."""
        columns = [self.scores[field.name].tolist() for field in _FIELDS]
        return [WorldScore(*row) for row in zip(*columns, strict=True)]

    def to_bytes(self) -> bytes:
        """For another process."""
        arrays: dict[str, Any] = {name: value for name, value in vars(self).items() if name != "scores"}
        arrays |= {_SCORE + name: column for name, column in self.scores.items()}
        content = io.BytesIO()
        np.savez_compressed(content, **arrays)
        return content.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """From another process; nothing in it is ever run. Raises ValueError for what is no such thing."""
        with np.load(io.BytesIO(content), allow_pickle=False) as held:
            arrays: dict[str, Any] = {name: held[name] for name in held.files}
        scores = {
            name.removeprefix(_SCORE): arrays.pop(name) for name in list(arrays) if name.startswith(_SCORE)
        }
        arrays["executed_s"] = float(arrays["executed_s"])
        return cls(scores=scores, **arrays)


_FIELDS = dataclasses.fields(WorldScore)
_SCORE = "score."


def together(parts: Sequence[Finished]) -> Finished:
    """Groups that ran one after another, as one; there is at least one. What a run keeps does not grow with
    the picture: only with the worlds, by some 300 bytes each.
    """
    first = parts[0]
    return Finished(
        scores={name: np.concatenate([part.scores[name] for part in parts]) for name in first.scores},
        met=np.sum([part.met for part in parts], axis=0),
        executed_s=float(sum(part.executed_s for part in parts)),
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in _BY_WORLD},
    )


_BY_WORLD = ("world", "steps", "diverged_at", "down", "travel", "whole_body")
