"""The integrator from Python: problems as functions, a thin ctypes binding of its test library."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

LANES = 8
OK, INVALID_INPUT, OUT_OF_DOMAIN, SINGULAR, NO_SOLUTION, NO_MEMORY = range(6)
STEP, EVENT, STOP = range(3)
GROWTH_NEVER, GROWTH_BY_COUPLING, GROWTH_BY_DAMPING = range(3)

Floats = NDArray[np.float64]
_double = ctypes.c_double
_int = ctypes.c_int
_doubles = ctypes.POINTER(_double)
_ints = ctypes.POINTER(_int)
_Vector = ctypes.CFUNCTYPE(_int, _double, _doubles, _doubles)
_Directions = ctypes.CFUNCTYPE(None, _ints)


class RefusedState(Exception):
    """Raised by a problem's function outside its domain; the integrator may try a smaller step."""


class BrokenModel(Exception):
    """Raised by a problem's function to end the integration."""


@dataclass
class Problem:
    """y' = f(t, y); jacobian gives the full matrix unless entries lists the ones that it gives."""

    f: Callable[[float, Floats], ArrayLike]
    jacobian: Callable[[float, Floats], ArrayLike]
    scale: ArrayLike
    roots: Callable[[float, Floats], ArrayLike] | None = None
    n_roots: int = 0
    directions: Callable[[], ArrayLike] | None = None
    entries: list[tuple[int, int]] | None = None
    growth: int = GROWTH_NEVER
    reach: ArrayLike | None = None  # of the states in a step
    cycle: float = np.inf  # of f, by time
    calls: dict[str, int] = field(default_factory=dict)


class Counts(NamedTuple):
    """What an integration cost."""

    steps: int
    rejections: int
    lane_evaluations: int
    evaluations: int
    jacobians: int
    factorisations: int
    dense_factorisations: int
    root_evaluations: int
    events: int
    growth_cuts: int


class GrowthLook(NamedTuple):
    """What a look at one Jacobian says of the modes that grow."""

    step_may_be_too_long: bool
    longest: float  # step that follows them; the largest number if none grows
    eigenvalue: complex  # that asks for it, or did before


class IntegrationError(Exception):
    """The integrator gave up; carries its code."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


def _array(values: ArrayLike, kind: type = np.float64) -> NDArray[Any]:
    return np.ascontiguousarray(values, dtype=kind)


def _pointer(values: NDArray[Any]) -> Any:
    return values.ctypes.data_as(_doubles if values.dtype == np.float64 else _ints)


class Library:
    """The functions of the test library."""

    def __init__(self, path: Path) -> None:
        self.c = ctypes.CDLL(str(path))
        for name in ("rt_new", "rt_new_chain"):
            getattr(self.c, name).restype = ctypes.c_void_p
        handle = ctypes.c_void_p
        self.c.rt_new.argtypes = [
            *(_int, _int, _ints, _ints, _doubles, _int, _Vector, _Vector, _Vector, _Directions),
            *(_double, _double, _double, _int, _doubles, _double),
        ]
        self.c.rt_new_chain.argtypes = [
            *(_int, _double, _double, _double, ctypes.c_bool, _double, _double),
        ]
        self.c.rt_delete.argtypes = [handle]
        self.c.rt_start.argtypes = [handle, _double, _doubles]
        self.c.rt_advance.argtypes = [handle, _double, _ints]
        self.c.rt_state.argtypes = [handle, _doubles, _doubles, _doubles, _ints]
        self.c.rt_interpolate.argtypes = [handle, _double, _doubles]
        self.c.rt_restart.argtypes = [handle, _double, _doubles]
        self.c.rt_counts.argtypes = [handle, _ints]
        self.c.rt_growth.argtypes = [handle, _doubles]
        self.c.rt_eigenvalues.argtypes = [_int, _doubles, _doubles, _doubles]
        self.c.rt_look_at_growth.argtypes = [
            *(_int, _int, _ints, _ints, _doubles, _int, _doubles, _doubles, _ints, _ints),
            *(_doubles, _doubles, _doubles),
        ]
        self.c.rt_find_candidates.argtypes = [_doubles, _int, _double, _double, _doubles]
        self.c.rt_message.argtypes = [handle, ctypes.c_char_p]
        self.c.rt_integrate_chain.argtypes = [
            *(handle, _doubles, _doubles, _double, _double, _int, _doubles),
        ]
        self.c.rt_basis.argtypes = [_double, _doubles]
        linear = [_int, _int, _ints, _ints, _doubles, _doubles, _doubles, _doubles, _doubles]
        self.c.rt_sparse_solve.argtypes = linear
        self.c.rt_dense_solve.argtypes = linear

    def tables(self) -> dict[str, Floats]:
        """Return the tables of the method, matrices indexed [row, column]."""
        square = (LANES, LANES)
        shapes = {"node": LANES, "to_stage": square, "from_stage": square}
        shapes |= {
            "shift_re": 4,
            "shift_im": 4,
            "barycentric": LANES,
            "slope": square,
            "chebyshev": square,
            "integral": square,
        }
        tables = {name: np.zeros(shape) for name, shape in shapes.items()}
        self.c.rt_tables(*(_pointer(table) for table in tables.values()))
        return {name: table.T if table.ndim == 2 else table for name, table in tables.items()}

    def basis(self, tau: float) -> Floats:
        """Lagrange polynomials of the nodes at tau."""
        values = np.zeros(LANES)
        self.c.rt_basis(tau, _pointer(values))
        return values

    def solve_systems(
        self, kind: str, entries: ArrayLike, values: ArrayLike, shifts: ArrayLike, right: ArrayLike
    ) -> tuple[int, NDArray[np.complex128], Floats]:
        """Solve (shift_k - J) x_k = right_k, right [4, n]; also the first with its real part.

        Returns the entries of the factors (0: refused; dense: 1), x [4, n], the real x_0.
        """
        right, shifts = np.asarray(right, complex), np.asarray(shifts, complex)
        n = right.shape[1]
        row, column = (_array(part, np.int32) for part in np.asarray(entries).T)
        b = np.concatenate([right.real, right.imag]).T.copy()
        first = right[0].real.copy()
        solve = getattr(self.c, f"rt_{kind}_solve")
        numbers = [_array(x) for x in (values, shifts.real, shifts.imag)]
        arrays = [_pointer(x) for x in (row, column, *numbers, b, first)]
        good = solve(n, len(row), *arrays)
        return good, b[:, :4].T + 1j * b[:, 4:].T, first

    def looks_at_growth(
        self, scale: ArrayLike, looks: Sequence[tuple[ArrayLike, float, bool]]
    ) -> list[GrowthLook]:
        """Look at full Jacobians, each for a step; with True another integration begins before."""
        states, n, k = _array(scale), len(np.asarray(scale)), len(looks)
        row, column = (_array(part.ravel(), np.int32) for part in np.indices((n, n)))
        jacobians = _array([np.ravel(jacobian) for jacobian, _, _ in looks])
        steps = _array([step for _, step, _ in looks])
        anew, may_be = _array([new for _, _, new in looks], np.int32), np.zeros(k, np.int32)
        longest, re, im = np.zeros(k), np.zeros(k), np.zeros(k)
        arrays = (row, column, states, jacobians, steps, anew, may_be, longest, re, im)
        pointers = [_pointer(array) for array in arrays]
        self.c.rt_look_at_growth(n, n * n, *pointers[:3], k, *pointers[3:])
        return [
            GrowthLook(bool(may), float(step), complex(*value))
            for may, step, *value in zip(may_be, longest, re, im, strict=True)
        ]

    def eigenvalues(self, matrix: ArrayLike) -> NDArray[np.complex128] | None:
        """Eigenvalues of a matrix; None if they were not found."""
        a = np.array(matrix, np.float64, order="F")
        re, im = np.zeros(len(a)), np.zeros(len(a))
        found = self.c.rt_eigenvalues(len(a), *(x.ctypes.data_as(_doubles) for x in (a, re, im)))
        return re + 1j * im if found else None


class Solver:
    """One integration, step by step."""

    def __init__(
        self,
        library: Library,
        problem: Problem,
        tolerance: float = 1e-9,
        max_step: float = np.inf,
        first_step: float = 0.0,
    ) -> None:
        self.c = library.c
        self.problem = problem
        scale = _array(problem.scale)
        reach = _array(np.full(len(scale), np.inf) if problem.reach is None else problem.reach)
        self.n, self.n_roots = len(scale), problem.n_roots
        entries = problem.entries or [(i, j) for i in range(self.n) for j in range(self.n)]
        self.rows, self.columns = (_array(part, np.int32) for part in np.array(entries).T)
        self.callbacks = (
            self._vector("f", problem.f, self.n),
            self._vector("jacobian", problem.jacobian, len(entries)),
            self._vector("roots", problem.roots, self.n_roots),
            _Directions(self._directions),
        )
        self.handle = self.c.rt_new(
            *(self.n, len(entries), _pointer(self.rows), _pointer(self.columns), _pointer(scale)),
            *(self.n_roots, *self.callbacks, tolerance, max_step, first_step, problem.growth),
            *(_pointer(reach), problem.cycle),
        )
        self._raise_message(INVALID_INPUT)

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.c.rt_delete(self.handle)

    def _vector(self, name: str, function: Callable[..., ArrayLike] | None, length: int) -> Any:
        def call(t: float, y: Any, values: Any) -> int:
            calls = self.problem.calls
            calls[name] = calls.get(name, 0) + 1
            try:
                result = np.ravel(function(t, np.ctypeslib.as_array(y, (self.n,)).copy()))
            except RefusedState:
                return OUT_OF_DOMAIN
            except Exception:  # cannot pass through Fortran
                return NO_SOLUTION
            np.ctypeslib.as_array(values, (length,))[:] = result
            return OK

        return _Vector(call)

    def _directions(self, values: Any) -> None:
        if self.n_roots:
            requested = self.problem.directions() if self.problem.directions else [0] * self.n_roots
            np.ctypeslib.as_array(values, (self.n_roots,))[:] = requested

    def _raise_message(self, code: int) -> None:
        text = ctypes.create_string_buffer(401)
        self.c.rt_message(self.handle, text)
        if text.value:
            raise IntegrationError(code, text.value.decode())

    def start(self, t: float, y: ArrayLike) -> None:
        """Begin at (t, y)."""
        self._check(self.c.rt_start(self.handle, t, _pointer(_array(y))))

    def advance(self, t_stop: float) -> int:
        """Make a step; returns its outcome."""
        outcome = _int(-1)
        self._check(self.c.rt_advance(self.handle, t_stop, ctypes.byref(outcome)))
        return outcome.value

    def _check(self, code: int) -> None:
        if code:
            self._raise_message(code)

    @property
    def state(self) -> tuple[float, float, Floats, NDArray[np.int32]]:
        """Start of the last step, present time and state, functions fired."""
        before, now, y = np.zeros(1), np.zeros(1), np.zeros(self.n)
        fired = np.zeros(max(1, self.n_roots), np.int32)
        self.c.rt_state(self.handle, *(_pointer(x) for x in (before, now, y, fired)))
        return float(before[0]), float(now[0]), y, fired[: self.n_roots]

    def interpolate(self, t: float) -> Floats:
        """State at t in the last step."""
        y = np.zeros(self.n)
        self.c.rt_interpolate(self.handle, t, _pointer(y))
        return y

    def restart(self, t: float, y: ArrayLike) -> None:
        """Go on from here after an event."""
        self.c.rt_restart(self.handle, t, _pointer(_array(y)))

    @property
    def counts(self) -> Counts:
        """What it has cost."""
        numbers = np.zeros(len(Counts._fields), np.int32)
        self.c.rt_counts(self.handle, _pointer(numbers))
        return Counts(*map(int, numbers))

    @property
    def growth(self) -> tuple[float, complex]:
        """Time and eigenvalue of the fastest growth for which steps were cut."""
        numbers = np.zeros(3)
        self.c.rt_growth(self.handle, _pointer(numbers))
        return float(numbers[0]), complex(numbers[1], numbers[2])

    def steps(
        self,
        t: float,
        y: ArrayLike,
        t_end: float,
        event: Callable[[float, Floats, NDArray[np.int32]], ArrayLike] | None = None,
    ) -> Iterator[tuple[float, Floats]]:
        """Integrate to t_end, one item a step; event gives the state after an event."""
        self.start(t, y)
        now = t
        while now < t_end:
            outcome = self.advance(t_end)
            _, now, y, fired = self.state
            yield now, y
            if outcome == EVENT:
                self.restart(now, event(now, y.copy(), fired) if event else y)

    def end(self, t: float, y: ArrayLike, t_end: float, **options: Any) -> Floats:
        """State at t_end."""
        for _, state in self.steps(t, y, t_end, **options):
            last = state
        return last
