"""Worlds: steps a second of every fidelity beside MuJoCo in C and a serial loop, and against their number."""

from experiments.benchmarks.worlds.rows import measured

__all__ = ["measured"]
