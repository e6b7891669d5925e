"""The arrays of trajectories.npz: what the robot of a few worlds really did, sample by sample."""

from collections.abc import Mapping, Sequence

import jax
import jax.numpy as jnp
import numpy as np

from experiments.paint_job import PaintTask
from sims.painting.mission import Mission
from sims.rollout import RECORD_EVERY
from sims.scenes.charts import AbstractChart
from sims.scoring import WorldScore

# Worlds whose trajectories are kept where nobody names some.
_KEPT = 4
# Arrays without an axis of worlds.
_OF_ALL = ("joint_names", "palette")

Recording = Mapping[str, np.ndarray]


def recorded(task: PaintTask, mission: Mission, worlds: Sequence[int], first: int = 0) -> Recording:
    """Arrays, by the names of `TRAJECTORIES`, of those rows of a group whose first world is `first`."""
    rows = np.array(worlds, int)
    record, truth = jax.tree.map(lambda x: np.asarray(x)[rows], mission.driven.record), mission.truth
    live, pen = record.live, record.pen > 0.5
    hand = mission.laid.colour
    return {
        "world": first + rows,
        "time": np.where(live, np.arange(live.shape[1]) * float(task.job.dt) * RECORD_EVERY, np.nan),
        "planned": record.planned,
        "pen": pen,
        "stroke": _strokes(pen & live),
        "colour": (np.zeros(live.shape) if hand is None else np.asarray(hand)[rows]).astype(np.int8),
        "brush": truth.position[rows],
        "brush_axis": truth.axis[rows],
        "normal": _normals(task.job.scene.chart, np.asarray(mission.laid.uv)[rows]),
        "base": record.base,
        "tilt": record.tilt,
        "odometry": record.odometry,
        "joints": record.arm,
        "halted": record.halted > 0.5,
        "mode": np.broadcast_to(mission.modes.paint[rows, None], live.shape).astype(np.int8),
        "joint_names": np.array(task.job.robot.chain.names),
        "palette": np.array(task.drawing.colours, float).reshape(-1, 3),
    }


def chosen(task: PaintTask, mission: Mission, index: np.ndarray, worlds: Sequence[int]) -> list[Recording]:
    """What is kept of a group for the worlds that a user named: nothing where none of them is in it."""
    rows = [world - int(index[0]) for world in worlds if world in index]
    return [recorded(task, mission, rows, int(index[0]))] if rows else []


def joined(parts: Sequence[Recording], worlds: Sequence[int]) -> Recording:
    """Recordings of several groups as one, in the order of `worlds`; those that are in no part are left out.

    Groups differ in length: the shorter end like worlds that have finished, with their last row repeated.
    """
    length = max(part["time"].shape[1] for part in parts)
    found = np.concatenate([part["world"] for part in parts]).tolist()
    order = [found.index(world) for world in worlds if world in found]
    return {
        name: array
        if name in _OF_ALL
        else np.concatenate([_longer(name, part[name], length) for part in parts])[order]
        for name, array in parts[0].items()
    }


def shown(rows: Sequence[WorldScore]) -> list[int]:
    """The median world by tracking error, the worst, then the first ones."""
    order = np.argsort([row.rmse_total if row.status == "ok" else np.inf for row in rows], kind="stable")
    picked = [int(order[(len(order) - 1) // 2]), int(order[-1]), *range(len(order))]
    return list(dict.fromkeys(picked))[:_KEPT]


def _strokes(down: np.ndarray) -> np.ndarray:
    """Numbers of the strokes as they were drawn: runs of samples with the pen down; -1 between them."""
    begins = np.diff(down, axis=1, prepend=False) & down
    return np.where(down, np.cumsum(begins, axis=1) - 1, -1).astype(np.int32)


def _normals(chart: AbstractChart, uv: np.ndarray) -> np.ndarray:
    flat = jax.jit(jax.vmap(chart.normal))(jnp.asarray(uv.reshape(-1, 2)))
    return np.asarray(flat).reshape(*uv.shape[:2], 3)


def _longer(name: str, array: np.ndarray, length: int) -> np.ndarray:
    if array.ndim < 2:
        return array
    tail = np.repeat(array[:, -1:], length - array.shape[1], axis=1)
    end = {"time": np.nan, "pen": False, "stroke": -1}
    return np.concatenate([array, np.full_like(tail, end[name]) if name in end else tail], axis=1)
