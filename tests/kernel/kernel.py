"""The kernel's parts from Python: a thin ctypes binding, arrays in and arrays out.

Each method is the procedure of the same name in `evolvent/kernel.h`, or with `test_` before it in
the `*_calls.f90` of the tests of its room. Units are SI; numbers broadcast against each other as in
numpy.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kernel.description import Kind, kinds

OK, INVALID_INPUT, OUT_OF_DOMAIN, SINGULAR, NO_SOLUTION, NO_MEMORY, STORE_FAILED = range(7)
CONTACT, DAMPING, FRICTION = range(3)
FAMILIES = ("contact", "damping", "friction")

_double = ctypes.c_double
_int = ctypes.c_int
_pair = _double * 2

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]


class Status(ctypes.Structure):
    """`evl_status`."""

    _fields_ = [
        ("code", _int),
        ("subject", _int),
        ("index", _int),
        ("field", ctypes.c_char * 48),
        ("message", ctypes.c_char * 320),
    ]


class LawChoice(ctypes.Structure):
    """A law of its family with its parameters: `given_law` of the tests."""

    _fields_ = [("law", _int), ("parameters", _double * 8)]


class ContactContext(ctypes.Structure):
    """`given_contact` of the tests."""

    _fields_ = [
        (name, _double) for name in ("h", "h_dot", "rho_a", "rho_b", "e_star", "width", "v0")
    ]


_PAIR_NUMBERS = (
    *("ratio", "pitch_radius_a", "pitch_radius_b", "centre_distance", "gamma_a"),
    *("alpha_inf", "alpha_w", "base_radius_a", "base_radius_b", "base_radius_sum", "rho"),
    *("base_pitch", "tip_radius_a", "tip_radius_b", "rho_start_a", "rho_start_b"),
    *("phi_a", "phi_b"),
)
_PAIR_POINTS = (
    *("centre_a", "centre_b", "t", "e", "point_k_a", "point_k_b"),
    *("point_a", "point_b", "pitch_point"),
)


class SpurPair(ctypes.Structure):
    """`c_spur_pair` of the tests; the points read as lists of two numbers."""

    _fields_ = [
        *((name, _double) for name in _PAIR_NUMBERS),
        *((name, _pair) for name in _PAIR_POINTS),
        ("contains_pitch_point", ctypes.c_bool),
    ]


class Flank(NamedTuple):
    """f with its gradient and Hessian at n points."""

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
    """A call that takes one case was refused."""

    code: int
    index: int
    field: str
    message: str

    def __str__(self) -> str:
        """Return the kernel's sentence."""
        return f"{self.field}: {self.message}"


def _floats(*values: ArrayLike) -> list[Floats]:
    """Broadcast against each other, to contiguous one-dimensional arrays of doubles."""
    arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=float)) for v in values))
    return [np.ascontiguousarray(a).copy() for a in arrays]


def _at(array: Any) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


class Kernel:
    """The parts of the kernel in a shared library."""

    def __init__(self, path: str | Path) -> None:
        self.library = ctypes.CDLL(str(path))
        self.library.test_law_friction_knee.restype = _double

    # ---- flank

    def _flank(self, name: str, points: ArrayLike, *between: Any) -> Flank:
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 2)
        n = len(points)
        result = Flank(np.empty(n), np.empty((n, 2)), np.empty((n, 2, 2)), np.empty(n, np.int32))
        getattr(self.library, name)(n, _at(points), *between, *map(_at, result))
        return result

    def involute_flank(
        self, points: ArrayLike, base_radius: float, hand: int = 1, form: str = "short"
    ) -> Flank:
        """Flank function in the wheel's frame; form: short, or the paper's polar one."""
        name = {"short": "test_involute_flank", "polar": "test_involute_flank_polar"}[form]
        return self._flank(name, points, _double(base_radius), hand)

    def involute_flank_housing(
        self, points: ArrayLike, centre: ArrayLike, angle: float, base_radius: float, hand: int = 1
    ) -> Flank:
        """Flank function in the housing frame."""
        centre = np.array(centre, dtype=float)
        between = (_at(centre), _double(angle), _double(base_radius), hand)
        return self._flank("test_involute_flank_housing", points, *between)

    def involute_points(self, roll_angles: ArrayLike, base_radius: float, hand: int = 1) -> Floats:
        """Points (n, 2) of the flank in the wheel's frame."""
        (xi,) = _floats(roll_angles)
        points = np.empty((len(xi), 2))
        self.library.test_involute_points(len(xi), _at(xi), _double(base_radius), hand, _at(points))
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
        """Geometry of a pair, by the paper's rule if alpha_w is None.

        Raises
        ------
        KernelError
            If the input is refused.
        """
        pair, status = SpurPair(), Status()
        centre = np.array(centre_a, dtype=float)
        self.library.test_spur_pair_derive(
            teeth_a,
            teeth_b,
            _double(pitch_radius_a),
            ctypes.c_bool(alpha_w is None),
            _double(alpha_w or 0.0),
            _double(chi),
            sigma,
            _at(centre),
            ctypes.byref(pair),
            ctypes.byref(status),
        )
        if status.code != OK:
            raise _error(status)
        return pair

    # ---- Johnson's force

    def johnson_force(self, h: ArrayLike, rho_sum: ArrayLike, e_star: ArrayLike) -> Force:
        """Force per unit width with its derivatives."""
        given = _floats(h, rho_sum, e_star)
        n = len(given[0])
        result = Force(np.empty(n), np.empty(n), np.empty(n), np.empty(n, np.int32))
        self.library.test_johnson_force(n, *map(_at, given), *map(_at, result))
        return result

    def johnson_penetration(
        self, force: ArrayLike, rho_sum: ArrayLike, e_star: ArrayLike
    ) -> tuple[Floats, Integers]:
        """Penetration from the force per unit width, and the codes."""
        given = _floats(force, rho_sum, e_star)
        n = len(given[0])
        h, codes = np.empty(n), np.empty(n, np.int32)
        self.library.test_johnson_penetration(n, *map(_at, given), _at(h), _at(codes))
        return h, codes

    def johnson_limits(self, rho_sum: float, e_star: float) -> tuple[float, float]:
        """Return the limits (15) of penetration and force."""
        rho, modulus = _floats(rho_sum, e_star)
        h, force = np.empty(1), np.empty(1)
        self.library.test_johnson_limits(1, _at(rho), _at(modulus), _at(h), _at(force))
        return float(h[0]), float(force[0])

    def johnson_iteration(self, eta: ArrayLike, nu: ArrayLike) -> Floats:
        """One turn of the paper's iteration."""
        eta, nu = _floats(eta, nu)
        result = np.empty(len(eta))
        self.library.test_johnson_iteration(len(eta), _at(eta), _at(nu), _at(result))
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
        """Force per unit width by the paper's iteration, the turns, and the codes."""
        given = _floats(h, rho_sum, e_star, start)
        n = len(given[0])
        force, turns, codes = np.empty(n), np.empty(n, np.int32), np.empty(n, np.int32)
        results = (force, turns, codes)
        self.library.test_johnson_iteration_force(
            n, *map(_at, given), _double(tolerance), max_turns, *map(_at, results)
        )
        return results

    # ---- laws

    def laws(self, family: int) -> list[Kind]:
        """Return the table of a family."""
        return kinds(self.library, FAMILIES[family])

    def law(self, family: int, name: str, **parameters: float) -> LawChoice:
        """Choose a law by name; parameters not given get their default."""
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
        """Check a choice.

        Raises
        ------
        KernelError
            If it is refused.
        """
        status = Status()
        self.library.test_law_validate(family, ctypes.byref(choice), ctypes.byref(status))
        if status.code != OK:
            raise _error(status)

    def law_elastic_force(self, choice: LawChoice, **context: ArrayLike) -> LawForce:
        """Elastic force over the width, at contexts given as arrays of their fields."""
        n, contexts = _contexts(context)
        result = LawForce(*np.empty((4, n)), np.empty(n, np.int32))
        self.library.test_law_elastic_force(n, ctypes.byref(choice), contexts, *map(_at, result))
        return result

    def law_elastic_limit(self, choice: LawChoice, **context: ArrayLike) -> str:
        """Return why the elastic force is out of its domain."""
        _, contexts = _contexts(context)
        message = ctypes.create_string_buffer(320)
        self.library.test_law_elastic_limit(ctypes.byref(choice), contexts, message)
        return message.value.decode()

    def law_penetration(
        self, choice: LawChoice, force: ArrayLike, **context: ArrayLike
    ) -> tuple[Floats, Integers]:
        """Penetration from the elastic force over the width, and the codes."""
        (force,) = _floats(force)
        n, contexts = _contexts({"h": np.zeros(len(force)), **context})
        h, codes = np.empty(n), np.empty(n, np.int32)
        self.library.test_law_penetration(
            n, ctypes.byref(choice), contexts, _at(force), _at(h), _at(codes)
        )
        return h, codes

    def law_elastic_potential(self, choice: LawChoice, **context: ArrayLike) -> Energy:
        """Elastic energy over the width."""
        n, contexts = _contexts(context)
        result = Energy(np.empty(n), np.empty(n), np.empty(n), np.empty(n, np.int32))
        self.library.test_law_elastic_potential(
            n, ctypes.byref(choice), contexts, *map(_at, result)
        )
        return result

    def law_viscous_force(
        self, contact: LawChoice, damping: LawChoice, **context: ArrayLike
    ) -> Viscous:
        """Viscous force over the width, and its derivatives."""
        n, contexts = _contexts(context)
        results = Viscous(*np.empty((5, n)))
        codes = np.empty(n, np.int32)
        self.library.test_law_viscous_force(
            n,
            ctypes.byref(contact),
            ctypes.byref(damping),
            contexts,
            *map(_at, results),
            _at(codes),
        )
        assert not codes.any()
        return results

    def law_friction_factor(
        self, choice: LawChoice, modes: ArrayLike, v_t: ArrayLike
    ) -> tuple[Floats, Floats]:
        """Friction factor on the branches `modes`, and its derivative to v_t."""
        branches, v = _floats(modes, v_t)
        branches = branches.astype(np.int32)
        factor, d_v = np.empty(len(v)), np.empty(len(v))
        self.library.test_law_friction_factor(
            len(v), ctypes.byref(choice), *map(_at, (branches, v, factor, d_v))
        )
        return factor, d_v

    def law_friction_mode(self, choice: LawChoice, v_t: ArrayLike) -> Integers:
        """Branch of the friction law that belongs to each sliding velocity."""
        (v,) = _floats(v_t)
        modes = np.empty(len(v), np.int32)
        self.library.test_law_friction_mode(len(v), ctypes.byref(choice), _at(v), _at(modes))
        return modes

    def law_friction_knee(self, choice: LawChoice) -> float:
        """Sliding velocity at which the branch changes."""
        return float(self.library.test_law_friction_knee(ctypes.byref(choice)))


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
