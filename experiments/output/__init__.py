"""What a command leaves behind: a folder that is whole or absent, its summary and its arrays."""

from experiments.output.arrays import write_parquet, write_trajectories
from experiments.output.folder import RunFolder, sweep
from experiments.output.summary import describe_device, describe_versions, read_summary, write_json

__all__ = [
    "RunFolder",
    "describe_device",
    "describe_versions",
    "read_summary",
    "sweep",
    "write_json",
    "write_parquet",
    "write_trajectories",
]
