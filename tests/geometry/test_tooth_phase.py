"""Places of the teeth in trains, checked on the outlines of the teeth themselves."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
import pytest

from kernel.kernel import INVALID_INPUT, OK, Floats, Kernel, Status, _double, _int

ALPHA = np.radians(20.0)  # of the rack and, without profile shift, of every mesh
MODULE = 3e-3


class ToothMesh(ctypes.Structure):
    """`c_tooth_mesh` of the tests."""

    _fields_ = [
        *((name, _int) for name in ("wheel_a", "wheel_b", "sigma")),
        *((name, _double) for name in ("chi", "alpha_w", "rho", "base_pitch", "rho_start")),
        ("backlash", _double),
    ]


class ToothPhase(ctypes.Structure):
    """`c_tooth_phase` of the tests."""

    _fields_ = [
        *((name, _double) for name in ("rho_start", "gap")),
        *((name, _int) for name in ("tooth_a", "tooth_b")),
    ]


@dataclass
class Train:
    """Standard gears of 20 degrees at their centres, thinned by half the backlash each."""

    teeth: list[int]
    centres: Floats  # (wheel, 2) [m]
    meshes: list[tuple[int, int, int]]  # driving, driven, sigma
    backlash: float = 0.0

    @property
    def base(self) -> Floats:
        return MODULE * np.array(self.teeth) / 2 * np.cos(ALPHA)

    @property
    def angles(self) -> Floats:
        """What a tooth fills on the base circle."""
        z = np.array(self.teeth)
        thickness = np.pi * MODULE / 2 - self.backlash / np.cos(ALPHA) / 2
        return 2 * thickness / (MODULE * z) + 2 * (np.tan(ALPHA) - ALPHA)

    def descriptions(self) -> list[ToothMesh]:
        found = []
        for a, b, sigma in self.meshes:
            line = self.centres[b] - self.centres[a]
            rho = np.linalg.norm(line) * np.sin(ALPHA)
            tip = np.sqrt((MODULE * (self.teeth[b] / 2 + 1)) ** 2 - self.base[b] ** 2)
            pitch = np.pi * MODULE * np.cos(ALPHA)
            chi = np.arctan2(line[1], line[0])
            found.append(ToothMesh(a, b, sigma, chi, ALPHA, rho, pitch, rho - tip, self.backlash))
        return found

    def phases(self, kernel: Kernel) -> tuple[int, list[ToothPhase], Status]:
        n, m = len(self.teeth), len(self.meshes)
        phases = (ToothPhase * m)()
        status = Status()
        code = kernel.library.test_tooth_phases(
            *(n, (_double * n)(*self.base), (_double * n)(*self.angles), (_int * n)(*self.teeth)),
            *(m, (ToothMesh * m)(*self.descriptions()), phases, ctypes.byref(status)),
        )
        return code, list(phases), status

    def middles(self, phases: list[ToothPhase]) -> list[tuple[float, float]]:
        """Middle of a tooth of each wheel of each mesh, where its own phase says it is.

        From the point of contact in space: it lies on the involute, whose root follows from it.
        """
        found = []
        meshes = zip(self.meshes, self.descriptions(), phases, strict=True)
        for (a, b, sigma), mesh, phase in meshes:
            turn = mesh.chi + sigma * ALPHA
            t = np.array([np.cos(turn), np.sin(turn)])
            e = sigma * np.array([t[1], -t[0]])
            on_a = self.centres[a] + self.base[a] * t + phase.rho_start * e
            on_b = on_a + phase.gap * e
            middles = []
            for wheel, point in ((a, on_a), (b, on_b)):
                x, y = point - self.centres[wheel]
                roll = np.arccos(self.base[wheel] / np.hypot(x, y))
                root = np.arctan2(y, x) - sigma * (np.tan(roll) - roll)
                middles.append(float(root + sigma * self.angles[wheel] / 2))
            found.append((middles[0], middles[1]))
        return found

    def clearance(self, mesh: int, middle_a: float, middle_b: float) -> float:
        """Least distance of the outlines of two wheels' teeth [m]; negative: they overlap."""
        a, b, _ = self.meshes[mesh]
        tip = MODULE * (self.teeth[a] / 2 + 1)
        radii = np.linspace(self.base[a] * (1 + 1e-9), tip, 4001)
        roll = np.arccos(self.base[a] / radii)
        half = self.angles[a] / 2 - (np.tan(roll) - roll)
        least = np.inf
        for tooth in range(self.teeth[a]):
            for side in (1, -1):
                angle = middle_a + 2 * np.pi * tooth / self.teeth[a] + side * half
                points = self.centres[a] + radii[:, None] * np.stack(
                    [np.cos(angle), np.sin(angle)], axis=1
                )
                x, y = (points - self.centres[b]).T
                distance = np.hypot(x, y)
                near = (distance < MODULE * (self.teeth[b] / 2 + 1)) & (distance > self.base[b])
                if not near.any():
                    continue
                roll_b = np.arccos(self.base[b] / distance[near])
                pitch = 2 * np.pi / self.teeth[b]
                off = np.arctan2(y[near], x[near]) - middle_b
                off = abs((off + pitch / 2) % pitch - pitch / 2)
                # along the base circle: the distance of an involute along its normals
                gap = off - (self.angles[b] / 2 - (np.tan(roll_b) - roll_b))
                least = min(least, float(gap.min() * self.base[b]))
        return least


def row(backlash: float = 0.0) -> Train:
    """Four wheels, each of which turns the next one, in any directions."""
    teeth = [23, 31, 20, 40]
    centres = [np.zeros(2)]
    for i, angle in enumerate((0.3, -1.1, 2.0)):
        distance = MODULE * (teeth[i] + teeth[i + 1]) / 2
        centres.append(centres[-1] + distance * np.array([np.cos(angle), np.sin(angle)]))
    return Train(teeth, np.array(centres), [(0, 1, 1), (1, 2, -1), (2, 3, 1)], backlash)


def split(teeth: tuple[int, int, int], angle: float, backlash: float = 0.0) -> Train:
    """Two equal idlers between an input and an output wheel; angle of the idlers at the input."""
    first, idler, last = teeth
    near, far = MODULE * (first + idler) / 2, MODULE * (idler + last) / 2
    x, y = near * np.cos(angle), near * np.sin(angle)
    centres = np.array([[0, 0], [x, y], [x, -y], [x + np.sqrt(far**2 - y**2), 0]])
    meshes = [(0, 1, 1), (1, 3, -1), (0, 2, 1), (2, 3, -1)]
    return Train([first, idler, idler, last], centres, meshes, backlash)


def unfolded(train: Train) -> float:
    """By which part of a tooth the loop of `split` does not close, by walking round it.

    Teeth on the inner arcs between the pitch points, counted forth on the outer wheels and back on
    the idlers: a whole number if the last tooth meets its space. Without backlash flanks and
    middles of teeth are the same there.
    """
    first, idler, last = train.teeth[0], train.teeth[1], train.teeth[3]
    c = train.centres
    at_first = 2 * np.arctan2(c[1][1], c[1][0])
    at_last = 2 * np.arctan2(c[1][1], c[3][0] - c[1][0])
    at_idler = np.pi - at_first / 2 - at_last / 2
    turns = first * at_first - 2 * idler * at_idler + last * at_last
    return float(turns / (2 * np.pi)) % 1.0


@pytest.mark.parametrize("backlash", [0.0, 5e-5])
def test_teeth_of_a_row_touch_in_every_mesh_and_nowhere_overlap(kernel: Kernel, backlash: float):
    train = row(backlash)
    code, phases, _ = train.phases(kernel)
    assert code == OK
    middles = train.middles(phases)
    assert phases[0].rho_start == train.descriptions()[0].rho_start  # the first begins at a
    for m, (a, b) in enumerate(middles):
        # 4001 points a flank, 1 mm long, curved by 1/rho: they miss the contact by 1e-9 m
        assert abs(train.clearance(m, a, b)) <= 1e-8
        start = train.descriptions()[m].rho_start
        pitch = train.descriptions()[m].base_pitch
        assert start <= phases[m].rho_start < start + pitch
    # a wheel in two meshes has its teeth where both say, so many teeth apart
    for m in (1, 2):
        driven, driving = middles[m - 1][1], middles[m][0]
        pitch = 2 * np.pi / train.teeth[m]
        teeth = (driving - driven) / pitch
        assert teeth == pytest.approx(round(teeth), abs=1e-12)
        assert round(teeth) % train.teeth[m] == phases[m].tooth_a
        assert phases[m - 1].tooth_b == 0


def test_wheels_that_drive_what_is_placed_already_meet_it_without_a_gap(kernel: Kernel):
    """Meshes told from the output to the input: each places the wheel that drives."""
    train = row(5e-5)
    train.meshes.reverse()
    code, phases, _ = train.phases(kernel)
    assert code == OK
    middles = train.middles(phases)
    for m, (a, b) in enumerate(middles):
        assert abs(train.clearance(m, a, b)) <= 1e-8
    for m in (1, 2):
        driving, driven = middles[m - 1][0], middles[m][1]
        teeth = (driven - driving) / (2 * np.pi / train.teeth[train.meshes[m][1]])
        assert teeth == pytest.approx(round(teeth), abs=1e-12)
        assert (phases[m].tooth_a, phases[m].gap) == (0, 0.0)


def closing_angle(teeth: tuple[int, int, int], near: float) -> float:
    """Angle of the idlers near `near` at which the loop closes without a gap."""
    low, high = near, near
    value = unfolded(split(teeth, near))
    step = 1e-4
    while True:
        high = low + step
        after = unfolded(split(teeth, high))
        if value > 0.5 > after and value - after > 0.5:
            break
        low, value = high, after
    for _ in range(80):
        middle = (low + high) / 2
        if unfolded(split(teeth, middle)) > 0.5:
            low = middle
        else:
            high = middle
    return (low + high) / 2


@pytest.mark.parametrize("teeth", [(20, 30, 50), (21, 30, 50), (20, 31, 47)])
def test_a_loop_closes_where_whole_teeth_lie_around_it(kernel: Kernel, teeth):
    angle = closing_angle(teeth, 0.55)
    train = split(teeth, angle)
    code, phases, status = train.phases(kernel)
    assert code == OK, status.message
    assert phases[3].gap <= 1e-12
    for m, middles in enumerate(train.middles(phases)):
        assert abs(train.clearance(m, *middles)) <= 1e-8
    # a quarter of a tooth away they do not
    away = split(teeth, angle + 1e-2)
    code, _, status = away.phases(kernel)
    assert code == INVALID_INPUT
    assert status.index == 3
    assert b"teeth do not fit" in status.message


def test_backlash_lets_a_loop_close_with_a_gap(kernel: Kernel):
    teeth, backlash = (20, 30, 50), 2e-4
    angle = closing_angle(teeth, 0.55)
    gaps = []
    for offset in np.linspace(-1e-3, 1e-3, 9):
        train = split(teeth, angle + offset, backlash)
        code, phases, _ = train.phases(kernel)
        if code != OK:
            continue
        gap = phases[3].gap
        gaps.append(gap)
        assert 0 <= gap <= backlash * (1 + 1e-9)
        # the outlines part by the gap on one side and the rest of the backlash on the other
        least = min(gap, backlash - gap)
        assert train.clearance(3, *train.middles(phases)[3]) == pytest.approx(least, abs=1e-8)
    assert len(gaps) >= 2
    assert max(gaps) > 0


@pytest.mark.parametrize("backlash", [2e-4, 0.75 * np.pi * MODULE * np.cos(ALPHA)])
def test_the_teeth_of_a_pair_with_a_gap_are_those_that_stand_there(kernel: Kernel, backlash: float):
    """However wide the gap: of teeth as thin as the second backlash leaves, most of a pitch."""
    teeth = (20, 30, 50)
    angle = closing_angle(teeth, 0.55)
    wide = backlash / (np.pi * MODULE * np.cos(ALPHA))  # in pitches; a radian opens some 30
    shares = []
    for offset in np.linspace(-1, 1, 25) * wide / 30:
        train = split(teeth, angle + offset, backlash)
        code, phases, _ = train.phases(kernel)
        if code != OK:
            continue
        shares.append(phases[3].gap / train.descriptions()[3].base_pitch)
        middles = train.middles(phases)
        for wheel, first, side in ((2, 2, 0), (3, 1, 1)):  # which mesh has placed it; its side
            apart = middles[3][side] - middles[first][1]
            count = apart / (2 * np.pi / train.teeth[wheel])
            assert count == pytest.approx(round(count), abs=1e-9)
            tooth = (phases[3].tooth_a, phases[3].tooth_b)[side]
            assert tooth == round(count) % train.teeth[wheel]
    assert max(shares) > 0.8 * wide


@pytest.mark.parametrize("known", [0, 1, 2])
def test_unknown_teeth_start_at_the_start_of_contact(kernel: Kernel, known: int):
    """All of them, or those of the wheels behind the first ones: a mesh needs both."""
    train = row()
    n = len(train.teeth)
    phases = (ToothPhase * 3)()
    angles = [*train.angles[:known], *[0.0] * (n - known)]
    code = kernel.library.test_tooth_phases(
        *(n, (_double * n)(*train.base), (_double * n)(*angles), (_int * n)(*train.teeth)),
        *(3, (ToothMesh * 3)(*train.descriptions()), phases, None),
    )
    assert code == OK
    for mesh, phase in zip(train.descriptions(), phases, strict=True):
        assert (phase.rho_start, phase.gap) == (mesh.rho_start, 0.0)
