"""The skeleton of pixels as a graph: nodes are tips and junctions, branches the pixels between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool
from scipy import ndimage

from jaxpaint.pictures.drawing import Polyline

_AROUND = [(-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1)]  # straight before diagonal

Pixel = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Branch:
    """Points (x, y) in pixels from one node to another, those of the nodes included."""

    nodes: tuple[int, int]
    points: Polyline


def graph_of(ink: Bool[np.ndarray, "rows columns"]) -> list[Branch]:
    """The branches of the skeleton of ink. Rings get a node of their own; a lone pixel is a branch too."""
    from skimage.morphology import skeletonize

    skeleton = np.pad(skeletonize(ink), 1)
    neighbours = ndimage.convolve(skeleton.astype(np.uint8), np.ones((3, 3), np.uint8), mode="constant") - 1
    is_node = skeleton & (neighbours != 2)
    label, count = ndimage.label(is_node, structure=np.ones((3, 3)))
    pixels: list[list[Pixel]] = [[] for _ in range(count + 1)]
    for row, column in np.argwhere(is_node):
        pixels[label[row, column]].append((int(row), int(column)))
    walk = _Walk(skeleton, label, pixels)
    branches = [branch for node in range(1, count + 1) for branch in walk.from_node(node)]
    branches += walk.rings(count + 1)
    # A padded pixel lies one further down and right than it does in the ink.
    return [Branch(branch.nodes, branch.points - 1) for branch in branches]


class _Walk:
    """Follows the pixels of a skeleton, each once."""

    def __init__(self, skeleton: np.ndarray, label: np.ndarray, pixels: list[list[Pixel]]):
        self.label, self.pixels = label, pixels
        self.between = frozenset((int(r), int(c)) for r, c in np.argwhere(skeleton & (label == 0)))
        self.unseen = set(self.between)

    def from_node(self, node: int) -> list[Branch]:
        """The branches that leave a node and were not found from their other end."""
        branches = []
        for pixel in self.pixels[node]:
            for start in _near(pixel):
                if start in self.unseen:
                    branches.append(self._branch(node, pixel, start))
        lone = not any(after in self.between for pixel in self.pixels[node] for after in _near(pixel))
        return [self._dot(node)] if lone else branches

    def _branch(self, node: int, pixel: Pixel, start: Pixel) -> Branch:
        path, here, before = [start], start, pixel
        self.unseen.discard(start)
        while True:
            # The first steps may still touch the node that they left.
            ends = [int(self.label[p]) for p in _near(here) if self.label[p] and p != before]
            ends = [end for end in ends if end != node or len(path) > 2]
            if ends:
                return Branch((node, ends[0]), self._points(node, path, ends[0]))
            after = [p for p in _near(here) if p in self.unseen]
            if not after:
                return Branch((node, node), self._points(node, path, node))
            before, here = here, after[0]
            path.append(here)
            self.unseen.discard(here)

    def rings(self, node: int) -> list[Branch]:
        """What is left when all nodes are done."""
        branches = []
        while self.unseen:
            start = min(self.unseen)
            self.unseen.discard(start)
            path, here = [start], start
            while after := [p for p in _near(here) if p in self.unseen]:
                here = after[0]
                path.append(here)
                self.unseen.discard(here)
            points = np.array([*path, start], float)[:, ::-1]
            branches.append(Branch((node, node), points))
            node += 1
        return branches

    def _dot(self, node: int) -> Branch:
        """A node without branches, from its first pixel to its last."""
        ends = np.array([min(self.pixels[node]), max(self.pixels[node])], float)[:, ::-1]
        return Branch((-2 * node, -2 * node - 1), ends)

    def _points(self, first: int, path: list[Pixel], last: int) -> Polyline:
        middle = [np.mean(self.pixels[node], axis=0) for node in (first, last)]
        return np.array([middle[0], *path, middle[1]], float)[:, ::-1]


def _near(pixel: Pixel) -> list[Pixel]:
    return [(pixel[0] + dr, pixel[1] + dc) for dr, dc in _AROUND]
