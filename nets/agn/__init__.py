"""AGN, S1's attention-aware graph network."""

from nets.agn.anchors import Patch
from nets.agn.blocks import BLOCK, block_order, padded_size
from nets.agn.network import AGN, AGNSettings, residuals
from nets.agn.patches import PATCH, refine

__all__ = [
    "AGN",
    "BLOCK",
    "PATCH",
    "AGNSettings",
    "Patch",
    "block_order",
    "padded_size",
    "refine",
    "residuals",
]
