"""Components of the kernel in Python: a thin ctypes binding with numpy arrays.

Each method is the procedure of the same name in `evolvent/kernel.h`, or with the prefix `test_` in
the `*_calls.f90` of the tests of its folder. Units are SI; arguments broadcast as in numpy.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kernel.description import Kind, kinds
from kernel.interface import Library, fields

OK, INVALID_INPUT, OUT_OF_DOMAIN, SINGULAR, NO_SOLUTION, NO_MEMORY, STORE_FAILED = range(7)
CONTACT, DAMPING, FRICTION = range(3)
FAMILIES = ("contact", "damping", "friction")

_double = ctypes.c_double
_int = ctypes.c_int

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]


class Status(ctypes.Structure):
    """`evl_status`."""

    _fields_ = fields("evl_status")


class LawChoice(ctypes.Structure):
    """A law of its family with its parameters."""

    _fields_ = fields("given_law", max_law_parameters=8)


class ContactContext(ctypes.Structure):
    """Contact quantities available to a law."""

    _fields_ = fields("given_contact")


class SpurPair(ctypes.Structure):
    """Geometry of a pair; points are lists of two numbers."""

    _fields_ = fields("c_spur_pair")


class Flank(NamedTuple):
    """Flank function f with its gradient and Hessian at n points."""

    value: Floats  # (n,)
    gradient: Floats  # (n, 2)
    hessian: Floats  # (n, 2, 2)
    code: Integers  # (n,)


class Force(NamedTuple):
    """A force with its derivatives."""

    force: Floats
    d_h: Floats
    d_rho: Floats
    code: Integers


class LawForce(NamedTuple):
    """An elastic force with its derivatives to the penetration and to both radii of curvature."""

    force: Floats
    d_h: Floats
    d_rho_a: Floats
    d_rho_b: Floats
    code: Integers


class Energy(NamedTuple):
    """Elastic energy with its derivatives to h and to rho_a + rho_b - h."""

    potential: Floats
    d_h: Floats
    d_length: Floats
    code: Integers


class Viscous(NamedTuple):
    """A viscous force with its derivatives."""

    force: Floats
    d_h: Floats
    d_rho_a: Floats
    d_rho_b: Floats
    d_h_dot: Floats


@dataclass
class KernelError(Exception):
    """Rejection of a call for a single case."""

    code: int
    index: int
    field: str
    message: str

    def __str__(self) -> str:
        """Return the kernel's message."""
        return f"{self.field}: {self.message}"


def _floats(*values: ArrayLike) -> list[Floats]:
    """Broadcast to contiguous one-dimensional arrays of doubles."""
    arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=float)) for v in values))
    return [np.ascontiguousarray(a).copy() for a in arrays]


def _at(array: Any) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


class Kernel:
    """Components of the kernel in a shared library."""

    def __init__(self, path: str | Path) -> None:
        self.library = Library(path)

    def checked(self, name: str, *given: Any) -> None:
        """Call a procedure with a status as last argument.

        Raises
        ------
        KernelError
            If the input is rejected.
        """
        status = Status()
        getattr(self.library, name)(*given, status)
        if status.code != OK:
            raise _error(status)

    def found(self, name: str, given: Sequence[Any], n: int, *shapes: tuple[int, ...]) -> list[Any]:
        """Call a procedure for n elements; return arrays of these shapes, and the codes."""
        results = [*(np.empty((n, *shape)) for shape in shapes), np.empty(n, np.int32)]
        getattr(self.library, name)(n, *given, *results)
        return results

    # ---- flank

    def _flank(self, name: str, points: ArrayLike, *between: Any) -> Flank:
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 2)
        shapes = ((), (2,), (2, 2))
        return Flank(*self.found(name, [points, *between], len(points), *shapes))

    def involute_flank(
        self, points: ArrayLike, base_radius: float, hand: int = 1, form: str = "short"
    ) -> Flank:
        """Flank function in the wheel's frame; form: short, or the paper's polar one."""
        name = {"short": "test_involute_flank", "polar": "test_involute_flank_polar"}[form]
        return self._flank(name, points, base_radius, hand)

    def involute_flank_housing(
        self, points: ArrayLike, centre: ArrayLike, angle: float, base_radius: float, hand: int = 1
    ) -> Flank:
        """Flank function in the housing frame."""
        between = (np.array(centre, dtype=float), angle, base_radius, hand)
        return self._flank("test_involute_flank_housing", points, *between)

    def involute_points(self, roll_angles: ArrayLike, base_radius: float, hand: int = 1) -> Floats:
        """Points (n, 2) of the flank in the wheel's frame."""
        (xi,) = _floats(roll_angles)
        points = np.empty((len(xi), 2))
        self.library.test_involute_points(len(xi), xi, base_radius, hand, points)
        return points

    # ---- geometry of a pair

    def spur_pair(
        self,
        teeth_a: int,
        teeth_b: int,
        pitch_radius_a: float,
        alpha_w: float | None = None,
        *,
        chi: float = 0.0,
        sigma: int = 1,
        centre_a: ArrayLike = (0.0, 0.0),
    ) -> SpurPair:
        """Geometry of a pair, by the paper's rule if alpha_w is None; raises KernelError."""
        pair, centre = SpurPair(), np.array(centre_a, dtype=float)
        given = (teeth_a, teeth_b, pitch_radius_a, alpha_w is None, alpha_w or 0.0, chi, sigma)
        self.checked("test_spur_pair_derive", *given, centre, pair)
        return pair

    # ---- Johnson's force

    def johnson_force(self, h: ArrayLike, rho_sum: ArrayLike, e_star: ArrayLike) -> Force:
        """Force per unit width with its derivatives."""
        given = _floats(h, rho_sum, e_star)
        return Force(*self.found("test_johnson_force", given, len(given[0]), (), (), ()))

    def johnson_penetration(
        self, force: ArrayLike, rho_sum: ArrayLike, e_star: ArrayLike
    ) -> tuple[Floats, Integers]:
        """Penetration from the force per unit width, and the codes."""
        given = _floats(force, rho_sum, e_star)
        h, codes = self.found("test_johnson_penetration", given, len(given[0]), ())
        return h, codes

    def johnson_limits(self, rho_sum: float, e_star: float) -> tuple[float, float]:
        """Return the limits (15) of penetration and force."""
        h, force = np.empty((2, 1))
        self.library.test_johnson_limits(1, *_floats(rho_sum, e_star), h, force)
        return float(h[0]), float(force[0])

    def johnson_iteration(self, eta: ArrayLike, nu: ArrayLike) -> Floats:
        """One iteration of the paper's method."""
        given = _floats(eta, nu)
        result = np.empty(len(given[0]))
        self.library.test_johnson_iteration(len(result), *given, result)
        return result

    def johnson_iteration_force(
        self,
        h: ArrayLike,
        rho_sum: ArrayLike,
        e_star: ArrayLike,
        start: ArrayLike,
        tolerance: float = 1e-15,
        max_turns: int = 100,
    ) -> tuple[Floats, Integers, Integers]:
        """Force per unit width by the paper's iteration, number of iterations, and codes."""
        given = _floats(h, rho_sum, e_star, start)
        n = len(given[0])
        results = (np.empty(n), np.empty(n, np.int32), np.empty(n, np.int32))
        self.library.test_johnson_iteration_force(n, *given, tolerance, max_turns, *results)
        return results

    # ---- laws

    def laws(self, family: int) -> list[Kind]:
        """Return the table of a family."""
        return kinds(self.library, FAMILIES[family])

    def law(self, family: int, name: str, **parameters: float) -> LawChoice:
        """Select a law by name; parameters not given have their defaults."""
        for index, info in enumerate(self.laws(family)):
            if info.name != name:
                continue
            choice = LawChoice(law=index)
            for i, row in enumerate(info.rows):
                default = None if row.required else float(row.default_text or "nan")
                choice.parameters[i] = parameters.pop(row.key, default)
            assert not parameters, f"law {name} has no {', '.join(parameters)}"
            return choice
        raise KeyError(name)

    def law_validate(self, family: int, choice: LawChoice) -> None:
        """Validate a law; raises KernelError if it is rejected."""
        self.checked("test_law_validate", family, choice)

    def law_elastic_force(self, choice: LawChoice, **context: ArrayLike) -> LawForce:
        """Elastic force over the width, at contexts given as arrays of their fields."""
        n, contexts = _contexts(context)
        shapes = ((), (), (), ())
        return LawForce(*self.found("test_law_elastic_force", [choice, contexts], n, *shapes))

    def law_elastic_limit(self, choice: LawChoice, **context: ArrayLike) -> str:
        """Return the reason why the elastic force is outside its domain."""
        message = ctypes.create_string_buffer(320)
        self.library.test_law_elastic_limit(choice, _contexts(context)[1], message)
        return message.value.decode()

    def law_penetration(
        self, choice: LawChoice, force: ArrayLike, **context: ArrayLike
    ) -> tuple[Floats, Integers]:
        """Penetration from the elastic force over the width, and the codes."""
        (force,) = _floats(force)
        n, contexts = _contexts({"h": np.zeros(len(force)), **context})
        h, codes = self.found("test_law_penetration", [choice, contexts, force], n, ())
        return h, codes

    def law_elastic_potential(self, choice: LawChoice, **context: ArrayLike) -> Energy:
        """Elastic energy over the width."""
        n, contexts = _contexts(context)
        given = [choice, contexts]
        return Energy(*self.found("test_law_elastic_potential", given, n, (), (), ()))

    def law_viscous_force(
        self, contact: LawChoice, damping: LawChoice, **context: ArrayLike
    ) -> Viscous:
        """Viscous force over the width, and its derivatives."""
        n, contexts = _contexts(context)
        given = [contact, damping, contexts]
        *results, codes = self.found("test_law_viscous_force", given, n, (), (), (), (), ())
        assert not codes.any()
        return Viscous(*results)

    def law_friction_factor(
        self, choice: LawChoice, modes: ArrayLike, v_t: ArrayLike
    ) -> tuple[Floats, Floats]:
        """Friction factor on the branches `modes`, and its derivative to v_t."""
        branches, v = _floats(modes, v_t)
        factor, d_v = np.empty((2, len(v)))
        given = (choice, branches.astype(np.int32), v)
        self.library.test_law_friction_factor(len(v), *given, factor, d_v)
        return factor, d_v

    def law_friction_mode(self, choice: LawChoice, v_t: ArrayLike) -> Integers:
        """Branch of the friction law for each sliding velocity."""
        (v,) = _floats(v_t)
        modes = np.empty(len(v), np.int32)
        self.library.test_law_friction_mode(len(v), choice, v, modes)
        return modes

    def law_friction_knee(self, choice: LawChoice) -> float:
        """Sliding velocity at the limit of the branches."""
        return float(self.library.test_law_friction_knee(choice))


def _error(status: Status) -> KernelError:
    return KernelError(status.code, status.index, status.field.decode(), status.message.decode())


def _contexts(fields: dict[str, ArrayLike]) -> tuple[int, ctypes.Array[ContactContext]]:
    """Array of contexts from arrays of their fields; fields not given are 0."""
    columns = dict(zip(fields, _floats(*fields.values()), strict=True))
    n = len(next(iter(columns.values())))
    contexts = (ContactContext * n)()
    for name, column in columns.items():
        for context, value in zip(contexts, column, strict=True):
            setattr(context, name, value)
    return n, contexts
