"""Gearbox of the kernel in Python: a thin ctypes binding of `evolvent/kernel.h`.

A `State` contains the data of a C caller; calls take states and return numpy arrays.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kernel.description import Block, described, kinds
from kernel.gearbox_description import EQUILIBRIUM, REST, case_of, initial
from kernel.interface import fields
from kernel.kernel import OK, Floats, Integers, Kernel, Status, _int
from kernel.wheel_store import WheelStore

OPEN, LOADED, UNLOADED, APART, OFF = range(5)
HELD = ("tooth_pair", "flanks", "friction", "zone_a", "zone_b")  # integers that are no sides
DRIVE, COAST = range(2)
OUTPUTS_OF_STATE, OUTPUTS_OF_STATIC, OUTPUTS_OF_EXTREMES = range(3)
OF_WHEEL, OF_MESH, OF_GEAR, OF_GEAR_MESH, OF_DEVIATION, OF_COMPLIANCE = range(6)
NOTHING, WHEEL, MESH, LOAD, INITIAL, HOUSING, SHAFT = range(7)
TRACKED = ("turn", "zeta", "dr_t", "dr_e", "gradient_ratio", "mu")


class Sizes(ctypes.Structure):
    """`evl_sizes`."""

    _fields_ = fields("evl_sizes")


class WheelGeometry(ctypes.Structure):
    """Geometry of a wheel as returned by `tests/gearbox/geometry_calls.f90`."""

    _fields_ = fields("c_wheel_geometry")


class MeshGeometry(ctypes.Structure):
    """Geometry of a mesh from the same file."""

    _fields_ = fields("c_mesh_geometry")


class EventRecord(ctypes.Structure):
    """`evl_event`."""

    _fields_ = fields("evl_event")


class Output(ctypes.Structure):
    """`evl_output`."""

    _fields_ = fields("evl_output")
    offset: int  # offset among the values of a gearbox
    count: int


@dataclass
class GearboxError(Exception):
    """Error of a call: rejected input, or a state outside the domain of the model."""

    code: int
    subject: int
    index: int
    field: str
    message: str

    def __str__(self) -> str:
        """Return the kernel's message."""
        return f"{self.field}: {self.message}"


@dataclass(frozen=True)
class Warned:
    """Warning about permitted input of a gearbox."""

    subject: int
    index: int
    field: str
    message: str


@dataclass(frozen=True)
class Event:
    """An event by name."""

    name: str
    mesh: int
    tooth_pair: int
    flank: int = DRIVE  # -1 without mesh


@dataclass
class State:
    """Time, continuous state with its derivative, discrete state."""

    t: float
    y: Floats
    yp: Floats
    integers: Integers
    reals: Floats

    @property
    def arrays(self) -> tuple[Floats, Integers, Floats]:
        """Arrays of a state without its derivative."""
        return self.y, self.integers, self.reals

    @property
    def all_arrays(self) -> tuple[Floats, Floats, Integers, Floats]:
        """Arrays of a state with its derivative."""
        return self.y, self.yp, self.integers, self.reals

    def copy(self) -> State:
        """Return a deep copy."""
        return deepcopy(self)


class Gearbox:
    """A gearbox of the kernel.

    Raises
    ------
    GearboxError
        From the constructor and from every call that does not return EVL_OK.
    """

    def __init__(
        self,
        kernel: Kernel,
        wheels: Sequence[Block],
        loads: Sequence[Block],
        meshes: Sequence[Block],
        housing: Block | None = None,
        shafts: Sequence[Block] = (),
        store: WheelStore | None = None,
        *,
        with_temperatures: bool = False,
    ) -> None:
        self.kernel = kernel
        self.library = kernel.library
        case, self.load_order = case_of(kernel, wheels, loads, meshes, housing, shafts)
        status = Status()
        with described(self.library, case, status) as description:
            self.handle = description and self.library.evl_gearbox_create(
                description, store, status
            )
            if self.handle and with_temperatures:
                code = self.library.evl_gearbox_add_temperatures(self.handle, description, status)
                self.check(code, status)
        if not self.handle:
            self.check(status.code, status)
        assert status.code == OK
        self.sizes = Sizes()
        self.library.evl_gearbox_sizes(self.handle, self.sizes)
        self.names = [self._name(i)[0] for i in range(self.sizes.n_states)]
        self.units = [self._name(i)[1] for i in range(self.sizes.n_states)]
        self.table = self._outputs()
        self.initial = initial()

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.library.evl_gearbox_delete(ctypes.byref(self.handle))

    def _about(self, status: Status) -> tuple[int, int, str, str]:
        """Object of a status; a load by its index in the given order."""
        index = self.load_order[status.index] if status.subject == LOAD else status.index
        return status.subject, index, status.field.decode(), status.message.decode()

    def check(self, code: int, status: Status) -> None:
        """Raise a GearboxError unless a call returned EVL_OK."""
        assert code == status.code
        if code != OK:
            raise GearboxError(code, *self._about(status))

    def _name(self, index: int) -> tuple[str, str]:
        name, units = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
        self.library.evl_gearbox_state_name(self.handle, index, name, units)
        return name.value.decode(), units.value.decode()

    def _outputs(self) -> list[Output]:
        """Return the table of outputs, with their offsets among the values of this gearbox."""
        n = self.sizes.n_outputs
        entries = output_table(self.library, OUTPUTS_OF_STATE)
        assert len(entries) == n
        offsets, counts = np.empty(n, np.int32), np.empty(n, np.int32)
        self.library.evl_gearbox_output_layout(self.handle, offsets, counts)
        for entry, offset, count in zip(entries, offsets, counts, strict=True):
            entry.offset, entry.count = int(offset), int(count)
        return entries

    def index(self, name: str) -> int:
        """Index of a state by its name."""
        return self.names.index(name)

    def tracked(self, mesh: int = 0) -> slice:
        """Indices of the tracked variables of a mesh."""
        first = self.index(f"turn_{mesh}")
        return slice(first, first + len(TRACKED))

    def _warning(self, index: int, start: Any = None) -> Warned | None:
        status = Status()
        if not self.library.evl_gearbox_warning(self.handle, start, index, status):
            return None
        assert status.code == OK
        return Warned(*self._about(status))

    def warnings(self) -> list[Warned]:
        """Warnings of the creation."""
        n = self.sizes.n_warnings
        found = [self._warning(index) for index in range(n + 1)]
        assert found[n] is None
        return [warned for warned in found if warned is not None]

    def speed_warning(self, kind: int = REST, speeds: ArrayLike | None = None) -> Warned | None:
        """Warning about the speeds of the loads and of a start; None if there is none."""
        return self._warning(self.sizes.n_warnings, initial(kind, speeds))

    def wheel_geometry(self, index: int) -> WheelGeometry:
        """Geometry of a wheel."""
        geometry = WheelGeometry()
        self.library.test_wheel_geometry(self.handle, index, geometry)
        return geometry

    def mesh_geometry(self, index: int = 0) -> MeshGeometry:
        """Geometry of a mesh."""
        geometry = MeshGeometry()
        self.library.test_mesh_geometry(self.handle, index, geometry)
        return geometry

    def quantities(self, of: int, index: int) -> dict[str, Any]:
        """Quantities of `evl_gearbox_geometry` by name: numbers, and points as lists."""
        rows = (Output * 40)()
        n = self.library.evl_gearbox_geometry(self.handle, of, index, rows)
        return {
            row.name.decode(): row.value[0] if row.n == 1 else list(row.value) for row in rows[:n]
        }

    # ---- states

    def start(
        self,
        kind: int = REST,
        speeds: ArrayLike | None = None,
        gaps: ArrayLike | None = None,
        t: float = 0.0,
        mesh_position: float | None = None,
    ) -> State:
        """State at the start; mesh_position: pitches past the start of contact.

        For a steady start; the start of contact if none is given for an equilibrium.
        """
        sizes = self.sizes
        state = State(
            t,
            np.full(sizes.n_states, np.nan),
            np.full(sizes.n_states, np.nan),
            np.full(sizes.n_integers, -99, np.int32),
            np.full(sizes.n_reals, np.nan),
        )
        self.initial = initial(kind, speeds, gaps)
        default = 0.0 if kind == EQUILIBRIUM else math.nan
        self.initial.mesh_position = default if mesh_position is None else mesh_position
        self._call("evl_gearbox_initial_state", self.initial, t, *state.all_arrays)
        return state

    def scales(self, duration: float = math.inf) -> tuple[Floats, Floats]:
        """Scales of states and rows for the last start of a run of this duration."""
        state, row = np.empty(self.sizes.n_states), np.empty(self.sizes.n_states)
        self.library.evl_gearbox_scales(self.handle, self.initial, duration, state, row)
        return state, row

    def _call(self, name: str, *arguments: Any) -> None:
        self.call(name, self.handle, *arguments)

    def call(self, name: str, *arguments: Any) -> None:
        """Call a procedure with a status as last argument; raises a GearboxError."""
        status = Status()
        self.check(getattr(self.library, name)(*arguments, status), status)

    def _filled(self, name: str, shape: int | tuple[int, int], *arguments: Any) -> Floats:
        """Return the array that a call fills."""
        result = np.empty(shape, order="F")
        self._call(name, *arguments, result)
        return result

    def residual(self, state: State) -> Floats:
        """Residual F(t, y, y')."""
        n = self.sizes.n_states
        return self._filled("evl_gearbox_residual", n, state.t, *state.all_arrays)

    def jacobian(self, state: State, cj: float) -> Floats:
        """Matrix dF/dy + cj dF/dy'."""
        n = self.sizes.n_states
        return self._filled("evl_gearbox_jacobian", (n, n), state.t, cj, *state.all_arrays)

    def listed_jacobian(self, state: State, cj: float) -> Floats | None:
        """Return the same from its structurally nonzero entries; None if all may be nonzero."""
        library, n, n_entries = self.library, self.sizes.n_states, ctypes.c_int()
        pattern = library.evl_pattern_create(self.handle, ctypes.byref(n_entries))
        if not pattern:
            return None
        rows, columns = (np.empty(n_entries.value, np.int32) for _ in range(2))
        library.evl_pattern_indices(pattern, rows, columns)
        assert np.all(np.diff(columns.astype(np.int64) * n + rows) > 0)  # in order, no duplicates
        values = np.full(n_entries.value, np.nan)
        try:
            self.call("evl_pattern_jacobian", pattern, state.t, cj, *state.all_arrays, values)
        finally:
            library.evl_pattern_delete(ctypes.byref(pattern))
        result = np.zeros((n, n))
        result[rows, columns] = values
        return result

    def derivative(self, state: State) -> Floats:
        """Derivative y' for y."""
        n = self.sizes.n_states
        return self._filled("evl_gearbox_derivative", n, state.t, *state.arrays)

    # ---- modes and events

    @cached_property
    def root_indices(self) -> dict[tuple[int, str], int]:
        """Indices of the root functions by (tooth contact, or -1, and name)."""
        names = self._names("test_root_name", self.sizes.n_roots)
        return {name: index for index, name in enumerate(names)}

    @cached_property
    def integer_names(self) -> list[tuple[int, str]]:
        """Integers of the discrete state: tooth contact, or -1, and name."""
        return self._names("test_integer_name", self.sizes.n_integers)

    def _names(self, function: str, n: int) -> list[tuple[int, str]]:
        names = []
        for index in range(n):
            name, contact = ctypes.create_string_buffer(32), _int()
            getattr(self.library, function)(self.handle, index, name, ctypes.byref(contact))
            names.append((contact.value, name.value.decode()))
        return names

    def put(self, state: State, name: str, value: int) -> None:
        """Set all integers of a name."""
        state.integers[[mine == name for _, mine in self.integer_names]] = value

    def mode(self, state: State, contact: int = 0) -> NDArray[np.int32]:
        """View of a tooth contact's pair, contact mode and friction branch, and zones if any.

        A pair by the paper's rule is one tooth contact; a pair of gears defined by a basic rack has
        the contacts of its drive flank, then those of its coast flank.
        """
        first = self.integer_names.index((contact, "tooth_pair"))
        n = 5 if (contact, "zone_a") in self.integer_names else 3
        return state.integers[first : first + n]

    @cached_property
    def sides(self) -> dict[int, tuple[int, str]]:
        """Indices of the sides of root functions, with the names of these functions."""
        names = enumerate(self.integer_names)
        return {at: name for at, name in names if name[0] >= 0 and name[1] not in HELD}

    def take_sides(self, state: State) -> None:
        """Set every undefined side (0) from the state, for states constructed by tests."""
        roots, directions = self.roots(state), self.root_directions(state)
        for index, name in self.sides.items():
            root = self.root_indices[name]
            if state.integers[index] == 0 and directions[root] != 0:
                state.integers[index] = 1 if roots[root] * directions[root] > 0 else -1

    def changing(self, events: list[Event]) -> list[Event]:
        """Return the events that change a mode, without those that are only recorded."""
        noted = {name for _, name in self.sides.values()}
        return [event for event in events if event.name not in noted]

    def check_modes(self, state: State) -> None:
        """Raise a GearboxError if the modes are inconsistent with the state."""
        self.take_sides(state)
        self.values(state, check=True)

    def roots(self, state: State) -> Floats:
        """Root functions."""
        return self._filled("evl_gearbox_roots", self.sizes.n_roots, *state.arrays)

    def root(self, state: State, name: str, contact: int = 0) -> float:
        """One root function of a tooth contact; 1 if it does not exist."""
        index = self.root_indices.get((contact, name))
        return 1.0 if index is None else float(self.roots(state)[index])

    def root_directions(self, state: State) -> Integers:
        """Active directions in the present modes."""
        result = np.empty(self.sizes.n_roots, np.int32)
        self.library.evl_gearbox_root_directions(self.handle, state.integers, result)
        return result

    def root_direction(self, state: State, name: str, contact: int = 0) -> int:
        """Direction of one root function of a tooth contact; 0 if inactive or not existing."""
        index = self.root_indices.get((contact, name))
        return 0 if index is None else int(self.root_directions(state)[index])

    def next_time_event(self, state: State) -> float:
        """Time of the next knot of a table."""
        return float(self.library.evl_gearbox_next_time_event(self.handle, state.integers))

    def apply(
        self, state: State, *roots: str, contact: int = 0, time_event: bool = False
    ) -> tuple[State, list[Event]]:
        """State after an event at which the named roots of a contact, or "revolution", passed 0."""
        indices = [
            self.root_indices[-1 if name == "revolution" else contact, name] for name in roots
        ]
        return self.apply_all(state, indices, time_event=time_event)

    def apply_all(
        self, state: State, indices: Sequence[int], *, time_event: bool = False
    ) -> tuple[State, list[Event]]:
        """State after an event at which the root functions with these indices passed 0."""
        fired = np.zeros(self.sizes.n_roots, np.int32)
        fired[list(indices)] = 1
        self.take_sides(state)
        after = state.copy()
        events = (EventRecord * (self.sizes.n_events))()
        n_events = _int(-1)
        results = (*after.all_arrays, events, ctypes.byref(n_events))
        self._call("evl_gearbox_apply_event", state.t, fired, time_event, *results)
        happened = [
            Event(event_names(self.kernel)[e.kind], e.mesh, e.tooth_pair, e.flank)
            for e in events[: n_events.value]
        ]
        return after, happened

    # ---- outputs

    def pitches(self, state: State, mesh: int = 0) -> float:
        """Rotation of the driving wheel of a mesh in pitches."""
        y, integers, _ = state.arrays
        return float(self.library.evl_gearbox_pitches(self.handle, mesh, y, integers))

    def turns(self, state: State, wheel: int = 0) -> float:
        """Revolutions of a wheel in its nominal direction."""
        y, integers, _ = state.arrays
        return float(self.library.evl_gearbox_turns(self.handle, wheel, y, integers))

    def can_turn(self, state: State, wheel: int = 0) -> bool:
        """Whether a wheel can rotate from this state on."""
        return bool(self.library.evl_gearbox_can_turn(self.handle, wheel, state.y, state.yp))

    def values(self, state: State, *, check: bool = False) -> Floats:
        """All outputs in one array of the kernel; with `check` modes must be consistent."""
        n = self.sizes.n_values
        return self._filled("evl_gearbox_outputs", n, state.t, *state.arrays, check)

    def sampled(
        self, states: Sequence[State], *names: str, n: int | None = None, check: bool = False
    ) -> Floats:
        """Values of outputs at states with the discrete state of the first one, by a sampler.

        All outputs if none is named. One row per state, of which the first n count. With `check`
        the states must be consistent with that discrete state.
        """
        table = {entry.name.decode(): i for i, entry in enumerate(self.table)}
        indices = np.array([table[name] for name in names or table], np.int32)
        sampler = self.library.evl_sampler_create(self.handle, len(indices), indices)
        result = np.full((sum(self.table[i].count for i in indices), len(states)), np.nan)
        times = np.array([state.t for state in states])
        y = np.array([state.y for state in states]).T.copy()
        arrays = (times, y, *states[0].arrays[1:])
        meant = len(states) if n is None else n
        try:
            self.call("evl_sampler_ask", sampler, len(states), meant, *arrays, check, result)
        finally:
            self.library.evl_sampler_delete(ctypes.byref(sampler))
        return result.T

    def outputs(self, state: State) -> dict[str, Floats]:
        """Existing outputs by name; those with an axis are (n, 2), in space (n, 3)."""
        values = self.values(state)
        result = {}
        for entry in self.table:
            if entry.count == 0:
                continue
            some = values[entry.offset : entry.offset + entry.count]
            columns = {3: 2, 4: 2, 7: 3, 8: self.sizes.n_pair_slots}.get(entry.dims)
            result[entry.name.decode()] = some.reshape(-1, columns) if columns else some
        return result


def event_names(kernel: Kernel) -> list[str]:
    """Names of the event kinds."""
    return [name for name, _ in event_kinds(kernel)]


def event_kinds(kernel: Kernel) -> list[tuple[str, str]]:
    """Names and texts of the event kinds."""
    return [(kind.name, kind.text) for kind in kinds(kernel.library, "event")]


def output_table(library: ctypes.CDLL, of: int) -> list[Output]:
    """One of the tables of outputs, without offsets."""
    table = (Output * library.evl_table(of, 0, None))()
    assert library.evl_table(of, len(table), table) == len(table)
    return list(table)
