"""How one-world functions become batched programs: everything that runs in many worlds goes through here."""

from jaxpaint.compiling.batch_last import batch_last
from jaxpaint.compiling.batched import CHUNK, Batched, batched, on_devices, one_by_one

__all__ = ["CHUNK", "Batched", "batch_last", "batched", "on_devices", "one_by_one"]
