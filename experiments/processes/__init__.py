"""One run in several processes: the worlds are split, one process gathers the scores and writes."""

from experiments.processes.launch import launch
from experiments.processes.peers import Peers, PeersLost, joined, left_in_disorder, peers

__all__ = ["Peers", "PeersLost", "joined", "launch", "left_in_disorder", "peers"]
