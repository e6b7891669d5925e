"""The sub-commands, one module each; a module is imported when its command is asked for."""

import importlib

from experiments.commands.command import Command, Outcome

MODULES = {
    "paint": "experiments.commands.paint",
    "reproduce": "experiments.commands.reproduce",
    "bench": "experiments.commands.bench",
    "compare": "experiments.commands.compare",
    "view": "experiments.commands.view",
}
"""Name of each command, and the module whose `COMMAND` it is."""


def find(name: str) -> Command:
    """The command of this name; KeyError where there is none."""
    return importlib.import_module(MODULES[name]).COMMAND


__all__ = ["MODULES", "Command", "Outcome", "find"]
