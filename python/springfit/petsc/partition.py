"""Which rank has which cells and points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


@dataclass
class Share:
    """What one rank has.

    Attributes:
        points: Of its cells, m, shape (points, dimension).
        blocks: Element names and the nodes of its cells, places in ``points``.
        numbers: Of its points in the order of all ranks, in which each rank owns a range.
        places: Of its points in the mesh.
        is_inside: Which of its points belong to no cell of another rank.
        total: The number of all points.
    """

    points: np.ndarray
    blocks: "list[tuple[str, np.ndarray]]"
    numbers: np.ndarray
    places: np.ndarray
    is_inside: np.ndarray
    total: int


def bisect(centres: np.ndarray, parts: int) -> np.ndarray:
    """The part of each centre by recursive coordinate bisection: the longest side of the bounding box is cut where the numbers of
    centres on both sides are as those of the parts (Berger, Bokhari 1987)."""
    part = np.zeros(len(centres), np.int32)
    waiting = [(np.arange(len(centres)), 0, parts)]
    while waiting:
        members, first, count = waiting.pop()
        if count == 1:
            part[members] = first
            continue
        below = count // 2
        own = centres[members]
        axis = int(np.argmax(np.ptp(own, axis=0)))
        cut = len(members) * below // count
        # Stable: centres in one plane are cut in the order of the mesh, the same on each machine.
        order = np.argsort(own[:, axis], kind="stable")
        waiting.append((members[order[:cut]], first, below))
        waiting.append((members[order[cut:]], first + below, count - below))
    return part


class Partition:
    """The cells and points of a mesh by ranks; a point belongs to the lowest rank with one of its cells.

    Attributes:
        starts: Where the range of each rank begins in the order of all ranks, and the end, shape (ranks + 1,).
        order: The places of the points in the mesh, in that order.
    """

    def __init__(self, points: np.ndarray, blocks: "list[tuple[str, np.ndarray]]", ranks: int) -> None:
        self._points, self._blocks = points, blocks
        centres = np.concatenate([points[nodes].mean(axis=1) for _, nodes in blocks])
        self._part = bisect(centres, ranks)
        owner, last = np.full(len(points), ranks, np.int32), np.full(len(points), -1, np.int32)
        first = 0
        for _, nodes in blocks:
            own = self._part[first : first + len(nodes)]
            for column in nodes.T:
                np.minimum.at(owner, column, own)
                np.maximum.at(last, column, own)
            first += len(nodes)
        self._is_inside = owner == last
        self.order = np.argsort(owner, kind="stable")
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=ranks))])
        self._number = np.empty(len(points), np.int64)
        self._number[self.order] = np.arange(len(points))

    def owned(self, rank: int) -> np.ndarray:
        """The places in the mesh of the points that a rank owns, in the order of all ranks."""
        return self.order[self.starts[rank] : self.starts[rank + 1]]

    def shares(self) -> "Iterator[Share]":
        """What each rank has, one after the other."""
        for rank in range(len(self.starts) - 1):
            chosen, first = [], 0
            for name, nodes in self._blocks:
                chosen.append((name, nodes[self._part[first : first + len(nodes)] == rank]))
                first += len(nodes)
            chosen = [(name, nodes) for name, nodes in chosen if len(nodes)]
            places = np.unique(np.concatenate([nodes.ravel() for _, nodes in chosen])) if chosen else np.zeros(0, np.int64)
            local = [(name, np.searchsorted(places, nodes)) for name, nodes in chosen]
            is_inside = self._is_inside[places]
            yield Share(self._points[places], local, self._number[places], places, is_inside, len(self._points))
