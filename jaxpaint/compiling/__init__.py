"""How one-world functions become batched programs: everything that runs in many worlds goes through here."""

from jaxpaint.compiling.batch_last import batch_last
from jaxpaint.compiling.batched import CHUNK, Batched, batched, on_devices, one_by_one
from jaxpaint.compiling.per_world import Batch, PerWorld, per_world, repeated, without_marks

__all__ = [
    "CHUNK",
    "Batch",
    "Batched",
    "PerWorld",
    "batch_last",
    "batched",
    "on_devices",
    "one_by_one",
    "per_world",
    "repeated",
    "without_marks",
]
