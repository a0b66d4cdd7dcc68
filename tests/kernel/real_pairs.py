"""One pair of gears defined by a basic rack at a state: all tooth pairs, absolute coordinates.

Based on docs/theory/geometry.md and docs/theory/deviations.md, with fifty digits. Teeth are found
by their positions on the wheels, forces by differences of the gap. Unlike the kernel, it does not
count from the start and uses neither deviations from a nominal motion nor lever arms of the forces.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from kernel.description import Block
from kernel.deviations import NONE, ROOT, TIP, Formula, Profile, deviations
from kernel.gearbox import COAST, DRIVE, LOADED, OFF, OPEN, Gearbox, State
from kernel.gearbox_description import BEARING, FIXED, SPEED, load, mesh, wheel
from kernel.gears import gear_description
from kernel.housing import length, turned, vector, wrapped
from kernel.kernel import Kernel

WIDTH = 0.02  # of both faces [m]


@dataclass(frozen=True)
class RealPair:
    """Two gears defined by a basic rack, wheel 0 driving; lengths in m, angles in rad."""

    teeth: tuple[int, int] = (19, 34)
    module: float = 3e-3
    pressure_angle: float = float(np.radians(20))
    shift: tuple[float, float] = (0.0, 0.0)
    allowance: tuple[float, float] = (0.0, 0.0)
    backlash: float = 5e-5
    ratio: float | None = None  # contact ratio, with tips equally far from the ends; None: standard
    dedendum: float = 1.25
    chi: float = 0.0
    sigma: int = 1
    centre: tuple[float, float] = (0.0, 0.0)
    reference: int = 0  # wheel whose angle is theta: the one with a prescribed speed
    fixed: bool = False  # axes that do not move
    poisson: tuple[float, float] = (0.3, 0.3)
    deviations: tuple[Block | None, Block | None] = (None, None)

    def gearbox(self, kernel: Kernel, loads: tuple[Block, ...] = (), **fields: Any) -> Gearbox:
        """Create the gearbox; fields of the mesh."""
        bearing = {
            **{"support_kind": FIXED if self.fixed else BEARING, "support_mass": 5.0},
            **{"support_stiffness": (1e9, 7e8), "support_damping": (1e5, 8e4)},
        }
        wheels = [
            wheel(
                teeth=self.teeth[i],
                width=WIDTH,
                centre=self.centre if i == 0 else None,
                poisson_ratio=self.poisson[i],
                gear=gear_description(
                    self.module,
                    pressure_angle=self.pressure_angle,
                    profile_shift=self.shift[i],
                    thickness_allowance=self.allowance[i],
                    rack_dedendum=self.dedendum,
                    **({} if self.ratio is None else {"tip_diameter": 2 * self.tip_radius(i)}),
                ),
                deviation=self.deviations[i] or deviations(),
                **bearing,
            )
            for i in (0, 1)
        ]
        if self.reference == 1:
            loads = (*loads, load(1, SPEED, 3.0))
        description = mesh(
            kernel,
            driving_rotation=-self.sigma,
            centre_line_angle=self.chi,
            backlash=self.backlash,
            **fields,
        )
        description.pop("pressure_angle")
        return Gearbox(kernel, wheels, loads, [description])

    # ---- geometry, docs/theory/geometry.md

    @cached_property
    def base_radii(self) -> tuple[mp.mpf, mp.mpf]:
        a, m = mp.mpf(self.pressure_angle), mp.mpf(self.module)
        return tuple(m * z / 2 * mp.cos(a) for z in self.teeth)  # type: ignore[return-value]

    @cached_property
    def base_pitch(self) -> mp.mpf:
        return mp.pi * mp.mpf(self.module) * mp.cos(mp.mpf(self.pressure_angle))

    @cached_property
    def tooth_angles(self) -> tuple[mp.mpf, mp.mpf]:
        """Angles of a tooth on the base circle."""
        a, m = mp.mpf(self.pressure_angle), mp.mpf(self.module)
        return tuple(  # type: ignore[return-value]
            2 * (m * (mp.pi / 2 + 2 * mp.mpf(x) * mp.tan(a)) + mp.mpf(s)) / (m * z)
            + 2 * (mp.tan(a) - a)
            for z, x, s in zip(self.teeth, self.shift, self.allowance, strict=True)
        )

    @cached_property
    def alpha_0(self) -> mp.mpf:
        """Working pressure angle: tooth thicknesses and backlash add up to the pitch."""
        teeth = mp.fdot(self.base_radii, self.tooth_angles)
        involute = (mp.mpf(self.backlash) + teeth - self.base_pitch) / (2 * sum(self.base_radii))
        return mp.findroot(lambda a: mp.tan(a) - a - involute, self.pressure_angle)

    @cached_property
    def rho_0(self) -> mp.mpf:
        return sum(self.base_radii) * mp.tan(self.alpha_0)

    def tip_radius(self, i: int) -> float:
        """Tip radius for the specified contact ratio [m]."""
        assert self.ratio is not None
        return float(mp.hypot(self.base_radii[i], (self.rho_0 + self.ratio * self.base_pitch) / 2))

    @cached_property
    def rho_tips(self) -> tuple[mp.mpf, mp.mpf]:
        """Radii of curvature at the tips."""
        if self.ratio is None:
            radii = [
                mp.mpf(self.module) * (mp.mpf(z) / 2 + 1 + mp.mpf(x))
                for z, x in zip(self.teeth, self.shift, strict=True)
            ]
        else:
            radii = [mp.mpf(self.tip_radius(i)) for i in (0, 1)]
        return tuple(  # type: ignore[return-value]
            mp.sqrt(r**2 - b**2) for r, b in zip(radii, self.base_radii, strict=True)
        )

    @cached_property
    def contact_ratio(self) -> float:
        return float((sum(self.rho_tips) - self.rho_0) / self.base_pitch)

    @property
    def slots(self) -> int:
        """Number of slots of each flank."""
        return int(np.ceil(self.contact_ratio - 1e-9)) + 1

    @cached_property
    def formulas(self) -> tuple[Formula, Formula]:
        """Deviations of the flanks of each wheel."""
        made = []
        for i in (0, 1):
            profile = Profile(
                self.teeth[i],
                float(self.base_radii[i]),
                self.module * self.teeth[i] / 2,
                float(self.rho_0 - self.rho_tips[1 - i]),
                float(self.rho_tips[i]),
                float(self.tooth_angles[i]),
            )
            made.append(Formula(self.deviations[i] or deviations(), profile))
        return made[0], made[1]

    @property
    def deviates(self) -> bool:
        return any(d is not None for d in self.deviations)

    @cached_property
    def middles(self) -> tuple[mp.mpf, mp.mpf]:
        """Angles of the middles of the teeth 0 at the start, in contact at the start of contact."""
        rho = self.rho_0 - self.rho_tips[1], self.rho_tips[1]
        return tuple(  # type: ignore[return-value]
            mp.mpf(self.chi)
            + self.sigma * (i * mp.pi + self.alpha_0 + self.tooth_angles[i] / 2 - rho[i] / r)
            for i, r in enumerate(self.base_radii)
        )


class Contact(NamedTuple):
    """Two opposite flanks on the path of contact."""

    flank: int
    number: int  # k, pitches since the start
    teeth: tuple[int, int]
    rho: tuple[mp.mpf, mp.mpf]
    zones: tuple[int, int]
    gap: mp.mpf


class Force(NamedTuple):
    """Load of a tooth pair: forces [N], torques on both wheels [N m], force on axis A [N]."""

    normal: mp.mpf
    friction: mp.mpf
    torques: tuple[mp.mpf, mp.mpf]
    on_a: np.ndarray
    loss: mp.mpf  # power of friction [W]
    dissipation: mp.mpf  # of damping and friction [W]


@dataclass
class Teeth:
    """The teeth of a pair at a state."""

    pair: RealPair
    gearbox: Gearbox
    state: State
    q: list[mp.mpf] = field(init=False)  # angles of A and B since the start, x and y of both axes
    rates: list[mp.mpf] = field(init=False)

    def __post_init__(self) -> None:
        theta = self._y("reference_angle") + 2 * mp.pi * int(self.state.integers[0])
        speed = self._y("reference_speed")
        z, ref = self.pair.teeth, self.pair.reference
        ratios = [mp.mpf(1) if i == ref else -mp.mpf(z[ref]) / z[i] for i in (0, 1)]
        self.q = [g * theta + self._y(f"angle_deviation_{i}") for i, g in enumerate(ratios)]
        self.rates = [g * speed + self._y(f"speed_deviation_{i}") for i, g in enumerate(ratios)]
        for i in (0, 1):
            self.q += [self._y(f"displacement_{x}_{i}") for x in "xy"]
            self.rates += [self._y(f"displacement_{x}_rate_{i}") for x in "xy"]

    def _y(self, name: str) -> mp.mpf:
        """State by name; 0 if it does not exist."""
        if name not in self.gearbox.names:
            return mp.mpf(0)
        return mp.mpf(float(self.state.y[self.gearbox.index(name)]))

    # ---- positions

    def line(self, q: list[mp.mpf]) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        """Direction of the centre line, pressure angle, length of the line of action."""
        p = self.pair
        distance = sum(p.base_radii) / mp.cos(p.alpha_0)
        c = turned(mp.mpf(p.chi), vector(distance, 0)) + vector(q[4] - q[2], q[5] - q[3])
        alpha = mp.acos(sum(p.base_radii) / length(c))
        return mp.atan2(c[1], c[0]), alpha, sum(p.base_radii) * mp.tan(alpha)

    def radius(self, q: list[mp.mpf], wheel: int, side: int, tooth: int) -> mp.mpf:
        """Radius of curvature of a flank at the line of action of its side."""
        p = self.pair
        chi, alpha, _ = self.line(q)
        root = p.middles[wheel] + q[wheel] + 2 * mp.pi * tooth / p.teeth[wheel]
        root -= side * p.tooth_angles[wheel] / 2
        return p.base_radii[wheel] * wrapped(wheel * mp.pi + alpha - side * (root - chi))

    def gap(
        self, q: list[mp.mpf], side: int, teeth: tuple[int, int], zones: tuple[int, int]
    ) -> mp.mpf:
        """Gap of two flanks, each on its branch of the deviations."""
        gap = self.line(q)[2]
        for i in (0, 1):
            rho = self.radius(q, i, side, teeth[i])
            gap += self.pair.formulas[i].e(rho, teeth[i], side, zones[i]) - rho
        return gap

    def side(self, flank: int) -> int:
        """Return +1 if the flanks of A in contact face clockwise, else -1."""
        return self.pair.sigma * (1 if flank == DRIVE else -1)

    def zone(self, wheel: int, rho: mp.mpf) -> int:
        """Zone of the profile."""
        formula = self.pair.formulas[wheel]
        tip, root = formula.relief(TIP), formula.relief(ROOT)
        if tip and rho > formula.start(tip):
            return TIP
        return ROOT if root and rho < formula.start(root) else NONE

    @cached_property
    def contacts(self) -> list[Contact]:
        """All pairs of flanks on the path of contact: both radii below those of the tips."""
        p = self.pair
        found = []
        for flank in (DRIVE, COAST):
            side = self.side(flank)
            near = [
                [
                    (t, rho)
                    for t in range(p.teeth[i])
                    if 0 < (rho := self.radius(self.q, i, side, t)) < p.rho_tips[i]
                ]
                for i in (0, 1)
            ]
            for a, rho_a in near[0]:
                for b, rho_b in near[1]:
                    if abs(self.line(self.q)[2] - rho_a - rho_b) > p.base_pitch / 2:
                        continue
                    zones = self.zone(0, rho_a), self.zone(1, rho_b)
                    gap = self.gap(self.q, side, (a, b), zones)
                    number = self.number(flank, rho_a)
                    found.append(Contact(flank, number, (a, b), (rho_a, rho_b), zones, gap))
        return found

    def first_radius(self, flank: int) -> mp.mpf:
        """Radius of curvature of the flank of A's tooth 0, extended beyond the path of contact."""
        p, side = self.pair, self.side(flank)
        chi, alpha, _ = self.line(self.q)
        chi = p.chi + wrapped(chi - p.chi)
        root = p.middles[0] + self.q[0] - side * p.tooth_angles[0] / 2
        return p.base_radii[0] * (alpha - side * (root - chi))

    def number(self, flank: int, rho_a: mp.mpf) -> int:
        """Pitches since the start: number of A's tooth after its tooth 0."""
        behind = (self.first_radius(flank) - rho_a) / self.pair.base_pitch
        return int(mp.nint(behind if flank == DRIVE else -behind))

    def settle(self, modes: dict[tuple[int, int], int] | None = None) -> State:
        """Assign the pairs on the path to their slots: loaded if they overlap; friction linear.

        modes: contact modes by (flank, number), instead.
        """
        p, n = self.pair, self.pair.slots
        _, _, rho = self.line(self.q)
        for flank in (DRIVE, COAST):
            on_path = {c.number: c for c in self.contacts if c.flank == flank}
            first = self.first_radius(flank)
            entry = rho - p.rho_tips[1] if flank == DRIVE else p.rho_tips[0]
            # numbers of the pairs that have entered: those up to this one
            entered = int(mp.floor((first - entry) * (1 if flank == DRIVE else -1) / p.base_pitch))
            for slot in range(n):
                integers = self.gearbox.mode(self.state, flank * n + slot)
                number = entered - (entered - slot) % n
                integers[:] = 0
                if number in on_path:
                    contact = on_path[number]
                    mode = LOADED if contact.gap < 0 else OPEN
                    integers[1] = (modes or {}).get((flank, number), mode)
                    if p.deviates:
                        integers[3:] = contact.zones
                else:
                    number += n
                    integers[1] = OFF
                integers[0] = number
        return self.state

    # ---- forces

    def gradient(self, contact: Contact) -> list[mp.mpf]:
        """Derivatives of the gap to q, by differences."""
        step = mp.mpf(10) ** -16
        result = []
        for i in range(6):
            values = []
            for sign in (1, -1):
                q = list(self.q)
                q[i] += sign * step
                side = self.side(contact.flank)
                values.append(self.gap(q, side, contact.teeth, contact.zones))
            result.append((values[0] - values[1]) / (2 * step))
        return result

    def force(
        self, contact: Contact, damping: float = 0.0, friction: tuple[float, float] = (0.0, 1.0)
    ) -> Force:
        """Johnson's force, a linear damper, friction of the linear part and beyond; clipped."""
        p, side, h = self.pair, self.side(contact.flank), -contact.gap
        gradient = self.gradient(contact)
        compliance = [(1 - mp.mpf(nu) ** 2) / mp.mpf(2e11) for nu in p.poisson]
        modulus = 1 / sum(compliance)
        x = mp.e * h / (4 * sum(contact.rho))
        elastic = -WIDTH * mp.pi * modulus * h / mp.lambertw(-x, -1).real
        viscous = -mp.mpf(damping) * mp.fdot(gradient, self.rates)
        normal = elastic + viscous
        chi, alpha, _ = self.line(self.q)
        across = vector(mp.cos(chi + side * alpha), mp.sin(chi + side * alpha))
        arms = [
            rho - p.formulas[i].e(rho, contact.teeth[i], side, contact.zones[i]) - c * modulus * h
            for i, (rho, c) in enumerate(zip(contact.rho, compliance, strict=True))
        ]
        axles = vector(self.rates[2] - self.rates[4], self.rates[3] - self.rates[5])
        v_t = side * mp.fdot(arms, self.rates[:2]) + axles[0] * across[0] + axles[1] * across[1]
        f, knee = friction
        tangential = -f * normal * max(mp.mpf(-1), min(mp.mpf(1), v_t / knee))
        torques = tuple(normal * gradient[i] + side * tangential * arms[i] for i in (0, 1))
        on_a = normal * vector(gradient[2], gradient[3]) + tangential * across
        loss = -tangential * v_t
        damped = -viscous * mp.fdot(gradient, self.rates)
        return Force(normal, tangential, torques, on_a, loss, damped + loss)  # type: ignore[arg-type]


def state_of(
    gearbox: Gearbox,
    pair: RealPair,
    random: np.random.Generator,
    *,
    gap: float,
    speed: float = 3.0,
    displacement: float = 2e-6,
) -> Teeth:
    """State at any revolution, with a given gap of the perfect drive flanks."""
    sizes = gearbox.sizes
    state = State(
        0.7,
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_integers, np.int32),
        np.full(sizes.n_reals, 0.01),
    )
    state.integers[0] = random.integers(-2, 3)
    values = {
        "reference_angle": random.uniform(-2 * np.pi, 2 * np.pi),
        "reference_speed": speed * random.choice([-1, 1]) * random.uniform(0.3, 1),
    }
    for name in gearbox.names:
        if name.startswith("displacement"):
            values[name] = displacement * random.uniform(-1, 1) * (100 if "rate" in name else 1)
        if name.startswith("speed_deviation"):
            values[name] = 1e-3 * random.uniform(-1, 1)
    for name, value in values.items():
        state.y[gearbox.index(name)] = value
    turning = 1 - pair.reference
    index = gearbox.index(f"angle_deviation_{turning}")
    for _ in range(2):
        now = perfect_gap(Teeth(pair, gearbox, state))
        state.y[index] += pair.sigma * float((gap - now) / pair.base_radii[turning])
    return Teeth(pair, gearbox, state)


def perfect_gap(teeth: Teeth) -> mp.mpf:
    """Gap of the drive flanks without deviations, from the angles of the teeth 0."""
    p = teeth.pair
    chi, alpha, rho = teeth.line(teeth.q)
    for i in (0, 1):
        root = p.middles[i] + teeth.q[i] - p.sigma * p.tooth_angles[i] / 2
        turn = wrapped(chi - p.chi) + p.chi
        rho -= p.base_radii[i] * (i * mp.pi + alpha - p.sigma * (root - turn))
    return rho
