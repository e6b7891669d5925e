"""One run in several processes: the worlds are split, one process gathers the scores and writes."""

from experiments.processes.launch import launch
from experiments.processes.peers import Peers, PeersLost, joined, peers
from experiments.processes.store import left_open

__all__ = ["Peers", "PeersLost", "joined", "launch", "left_open", "peers"]
