"""Plane bodies of curved quadrilaterals, condensed by the kernel (`element_calls.f90`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from kernel.kernel import Floats, Integers, Kernel, _at, _double

# a curve: points (n, 2) at n places from 0 to 1
Curve = Callable[[Floats], Floats]
SIDES = ((0, 1), (1, 2), (3, 2), (0, 3))  # corners at both ends of each side


def lobatto(kernel: Kernel, p: int) -> tuple[Floats, Floats, Floats]:
    """Points, weights and derivatives (at, of)."""
    x, w, d = np.empty(p + 1), np.empty(p + 1), np.empty((p + 1, p + 1))
    kernel.library.test_lobatto(p, _at(x), _at(w), _at(d))
    return x, w, d.T


def straight(a: Floats, b: Floats) -> Curve:
    """Straight line."""
    return lambda t: a + t[:, None] * (b - a)


@dataclass
class Body:
    """A mesh: vertices by their coordinates, elements, and their nodes."""

    kernel: Kernel
    p: int
    corners: list[list[int]] = field(default_factory=list)
    groups: list[int] = field(default_factory=list)
    sides: list[Floats] = field(default_factory=list)
    vertices: list[Floats] = field(default_factory=list)

    def vertex(self, at: Floats) -> int:
        """Number of the vertex at a place, from 1."""
        for i, known in enumerate(self.vertices):
            if np.hypot(*(known - at)) < 1e-9:
                return i + 1
        self.vertices.append(np.asarray(at, float))
        return len(self.vertices)

    def patch(self, curves: list[Curve], n: int, m: int, group: int) -> None:
        """Divide the transfinite patch between four sides into n times m elements."""
        x = lobatto(self.kernel, self.p)[0]

        def at(u: Floats, v: Floats) -> Floats:
            low, right, high, left = curves
            ends = [curve(np.array([0.0, 1.0])) for curve in (low, high)]
            u_, v_ = u[:, None], v[:, None]
            return (
                (1 - v_) * low(u)
                + v_ * high(u)
                + (1 - u_) * left(v)
                + u_ * right(v)
                - (1 - u_) * ((1 - v_) * ends[0][0] + v_ * ends[1][0])
                - u_ * ((1 - v_) * ends[0][1] + v_ * ends[1][1])
            )

        t, one = (1 + x) / 2, np.ones(self.p + 1)
        for j in range(m):
            for i in range(n):
                u, v = (i + t) / n, (j + t) / m
                lines = [
                    at(u, one * j / m),
                    at(one * (i + 1) / n, v),
                    at(u, one * (j + 1) / m),
                    at(one * i / n, v),
                ]
                points = [lines[0][0], lines[0][-1], lines[2][-1], lines[2][0]]
                self.corners.append([self.vertex(point) for point in points])
                self.groups.append(group)
                self.sides.append(np.array(lines))

    def nodes(self) -> tuple[Integers, int]:
        """Nodes of each element's sides (element, side, 0..p) from 0, and how many there are."""
        corner = np.array(self.corners, np.int32)
        rim = np.empty((len(corner), 4 * self.p), np.int32)
        n = self.kernel.library.test_number_nodes(self.p, len(corner), _at(corner), _at(rim))
        p = self.p
        around = np.concatenate([rim, rim[:, :1]], axis=1) - 1
        sides = [
            around[:, : p + 1],
            around[:, p : 2 * p + 1],
            around[:, 3 * p : 2 * p - 1 : -1],
            around[:, 4 * p : 3 * p - 1 : -1],
        ]
        return np.stack(sides, axis=1), n

    def points(self) -> Floats:
        """Coordinates of the nodes."""
        sides, n = self.nodes()
        at = np.empty((n, 2))
        at[sides.ravel()] = np.array(self.sides).reshape(-1, 2)
        return at

    def condensed(
        self,
        fixed: Integers,
        kept: Integers,
        loads: Floats,
        *,
        nu: float = 0.3,
        stress: bool = False,
    ) -> Floats:
        """Stiffness of the kept unknowns (2 node, 2 node + 1), then the loads; E = 1."""
        n = 2 * self.nodes()[1]
        is_fixed = np.zeros(n, np.int32)
        is_fixed[fixed] = 1
        load = np.ascontiguousarray(np.reshape(loads, (-1, n)))
        size = len(kept) + len(load)
        answer = np.empty((size, size))
        corner, group = np.array(self.corners, np.int32), np.array(self.groups, np.int32)
        side = np.ascontiguousarray(self.sides)
        unknowns = np.asarray(kept, np.int32) + 1
        failed = self.kernel.library.test_condense(
            *(self.p, len(group), _at(corner), _at(group), _at(side), _double(nu), int(stress)),
            *(n, _at(is_fixed), len(kept), _at(unknowns), len(load), _at(load), _at(answer)),
        )
        assert failed == 0, f"element {failed}"
        return answer
