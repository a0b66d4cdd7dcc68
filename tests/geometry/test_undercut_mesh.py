"""Meshes of undercut gears: path of contact and tips, against an envelope made here.

The fillet is the offset of the trochoid of the rack's tip centre by the normal of that curve; the
kernel uses the pitch point instead. Tips are moved over the gear in small rotations.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

from kernel.gear_reference import inv, inverse_inv
from kernel.gears import GearGeometry, GearMesh, gear, gear_mesh, mesh_geometry, tip_gap
from kernel.kernel import Floats, Kernel, KernelError

DIGITS = 40
M = 0.002
ALPHA = np.radians(20)
RACK = (1.0, 1.25, 0.38)


@dataclass
class Gear:
    """A gear as given: rack in modules, pressure angle of 20 degrees."""

    teeth: int
    shift: float = 0.0
    allowance: float = 0.0
    rounding: float = 0.0
    rack: tuple[float, float, float] = RACK

    def of_kernel(self, kernel: Kernel) -> GearGeometry:
        """Let the kernel derive it."""
        names = ("rack_addendum", "rack_dedendum", "rack_root_radius")
        given = dict(zip(names, self.rack, strict=True))
        return gear(
            kernel,
            self.teeth,
            M,
            profile_shift=self.shift,
            thickness_allowance=self.allowance,
            tip_rounding=self.rounding,
            **given,
        )

    @property
    def reference(self) -> mp.mpf:
        """The reference radius."""
        return mp.mpf(M) * self.teeth / 2

    @property
    def base(self) -> mp.mpf:
        """The base radius."""
        return self.reference * mp.cos(mp.mpf(ALPHA))

    @property
    def tip(self) -> mp.mpf:
        """The tip radius."""
        return self.reference + mp.mpf(M) * (mp.mpf(self.shift) + self.rack[0])

    @property
    def generating_shift(self) -> mp.mpf:
        """Shift of the tool, which also cuts the allowance."""
        of_allowance = mp.mpf(self.allowance) / (2 * mp.mpf(M) * mp.tan(mp.mpf(ALPHA)))
        return mp.mpf(self.shift) + of_allowance

    def tool_centre(self) -> tuple[mp.mpf, mp.mpf]:
        """Centre of the tool's tip rounding: beside the tool's axis, below the rolling line."""
        alpha, m, rho = mp.mpf(ALPHA), mp.mpf(M), mp.mpf(self.rack[2])
        below = mp.mpf(self.rack[1]) - rho
        x = mp.pi / 4 - below * mp.tan(alpha) - rho / mp.cos(alpha)
        return m * x, m * (below - self.generating_shift)

    def fillet(self, phi: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        """Radius of a point of the fillet, and its angle from the middle of the tooth space."""
        x, depth = self.tool_centre()
        r, rho = self.reference, mp.mpf(M) * mp.mpf(self.rack[2])
        turn = mp.expj(phi)
        centre = mp.mpc(x + r * phi, r - depth) * turn
        rate = (r + mp.mpc(0, 1) * mp.mpc(x + r * phi, r - depth)) * turn
        point = centre - rho * mp.mpc(0, 1) * rate / abs(rate)  # into the gear
        return abs(point), mp.atan2(point.real, point.imag)

    def involute(self, radius: mp.mpf) -> mp.mpf:
        """Angle of the involute at a radius from the middle of the tooth space."""
        alpha, m = mp.mpf(ALPHA), mp.mpf(M)
        thickness = m * (mp.pi / 2 + 2 * self.generating_shift * mp.tan(alpha))
        half = (mp.pi * m - thickness) / (2 * self.reference)
        return half - inv(alpha) + inv(mp.acos(self.base / radius))

    def form(self) -> mp.mpf:
        """Radius at which the fillet crosses the involute of an undercut tooth."""
        x, depth = self.tool_centre()
        bottom = -x / self.reference  # the centre stands over the pitch point
        end = bottom + depth / mp.tan(mp.mpf(ALPHA)) / self.reference

        def lies_inside(phi: mp.mpf) -> bool:
            radius, angle = self.fillet(phi)
            return radius <= self.base or angle > self.involute(radius)

        low, high = bottom, end
        for _ in range(int(3.5 * DIGITS)):
            middle = (low + high) / 2
            low, high = (middle, high) if lies_inside(middle) else (low, middle)
        return self.fillet(high)[0]

    def is_undercut(self) -> bool:
        """Whether the tool's flank ends above the point where it touches the base circle."""
        alpha = mp.mpf(ALPHA)
        flank = mp.mpf(self.rack[1]) - mp.mpf(self.rack[2]) * (1 - mp.sin(alpha))
        return bool(
            self.reference * mp.sin(alpha) ** 2 < mp.mpf(M) * (flank - self.generating_shift)
        )


def curvature(base: mp.mpf, radius: mp.mpf) -> mp.mpf:
    return mp.sqrt(radius**2 - base**2)


def tip_curvature(one: Gear) -> mp.mpf:
    """Radius of curvature where the rounded tip begins."""
    rounding = mp.mpf(one.rounding)
    return rounding + curvature(one.base, one.tip - rounding)


def exact_mesh(a: Gear, b: Gear) -> dict[str, mp.mpf]:
    """The mesh without given distance: allowances leave the backlash."""
    alpha = mp.mpf(ALPHA)
    shifts = mp.mpf(a.shift) + mp.mpf(b.shift)
    alpha_w = inverse_inv(inv(alpha) + 2 * mp.tan(alpha) * shifts / (a.teeth + b.teeth))
    distance = (a.reference + b.reference) * mp.cos(alpha) / mp.cos(alpha_w)
    line = distance * mp.sin(alpha_w)
    first, last = line - tip_curvature(b), tip_curvature(a)
    if a.is_undercut():
        first = max(first, curvature(a.base, a.form()))
    if b.is_undercut():
        last = min(last, line - curvature(b.base, b.form()))
    pitch = mp.pi * mp.mpf(M) * mp.cos(alpha)
    rho_pitch = a.base * mp.tan(alpha_w)
    return {
        "centre_distance": distance,
        "working_pressure_angle": alpha_w,
        "line_of_action": line,
        "path_of_contact": last - first,
        "contact_ratio": (last - first) / pitch,
        "approach": rho_pitch - first,
        "recess": last - rho_pitch,
        "rho_end_a": last,
        "rho_end_b": line - first,
        "active_radius_a": mp.sqrt(a.base**2 + first**2),
        "active_radius_b": mp.sqrt(b.base**2 + (line - last) ** 2),
    }


def check_mesh(kernel: Kernel, a: Gear, b: Gear) -> GearMesh:
    """Compare all of a mesh that is accepted."""
    mesh = gear_mesh(kernel, a.of_kernel(kernel), b.of_kernel(kernel))
    with mp.workdps(DIGITS):
        for name, value in exact_mesh(a, b).items():
            assert getattr(mesh, name) == pytest.approx(float(value), rel=1e-9, abs=1e-12), name
    return mesh


STANDARD = [(12, 30), (30, 12), (12, 12), (15, 40), (40, 15), (14, 17)]


@pytest.mark.parametrize(("za", "zb"), STANDARD)
def test_standard_gears_mesh_between_their_form_circles(kernel: Kernel, za: int, zb: int) -> None:
    a, b = Gear(za), Gear(zb)
    mesh = check_mesh(kernel, a, b)
    assert mesh.contact_ratio >= 1.0
    assert mesh.rho_end_a < mesh.rho_tip_a or mesh.rho_end_b < mesh.rho_tip_b


def drawn(seed: int) -> tuple[Gear, Gear]:
    """A pair of which at least one gear is undercut, and may be anything else."""
    draw = np.random.default_rng(seed)
    small = Gear(int(draw.integers(8, 17)), float(draw.uniform(-0.3, 0.3)))
    rounded = 0.1 * M * float(draw.integers(0, 2))
    large = Gear(int(draw.integers(8, 80)), float(draw.uniform(-0.4, 0.4)), rounding=rounded)
    for one in (small, large):
        one.allowance = -float(draw.uniform(0, 0.05)) * M
        one.rack = (float(draw.uniform(0.9, 1.2)), 1.25, float(draw.uniform(0.1, 0.38)))
    return (small, large) if draw.integers(0, 2) else (large, small)


def test_random_undercut_pairs_have_the_path_that_the_envelopes_leave(kernel: Kernel) -> None:
    shortened = refused = 0
    for seed in range(60):
        a, b = drawn(seed)
        try:
            mesh = check_mesh(kernel, a, b)
        except KernelError as error:
            refused += 1
            text = str(error)
            if "leaves it a contact ratio" in text:
                with mp.workdps(DIGITS):
                    assert exact_mesh(a, b)["contact_ratio"] < 1
            else:
                reasons = ("tip interference", "no part of the profile", "pointed", "root circle")
                assert any(reason in text for reason in reasons), text
            continue
        shortened += mesh.rho_end_a < mesh.rho_tip_a or mesh.rho_end_b < mesh.rho_tip_b
    assert shortened > 15
    assert refused > 3


# ---- tips, by rotation in small steps


def polar(points: Floats) -> tuple[Floats, Floats]:
    """Radius, and angle from the y axis."""
    return np.hypot(points[0], points[1]), np.arctan2(points[0], points[1])


def cut_profile(one: Gear) -> tuple[Floats, Floats]:
    """Radii, and the angle to which a rack that rolls over the gear cuts between two of them.

    The angle is from the point of the flank, or of the involute continued, on the base circle.
    """
    r, base = float(one.reference), float(one.base)
    x, depth = (float(value) for value in one.tool_centre())
    rho = M * one.rack[2]
    along = np.linspace(
        0, np.pi / 2 - ALPHA, 400
    )  # normals of the rounding, from down to the flank
    arc = np.array([x + rho * np.sin(along), -depth - rho * np.cos(along)])
    t = np.linspace(0, 2.2 * M, 400)
    flank = arc[:, -1:] + np.array([t * np.tan(ALPHA), t])
    tool = np.hstack([arc, flank])
    edges = np.linspace(float(r - depth - rho) * (1 + 1e-12), float(one.tip), 601)
    furthest = np.full(len(edges) - 1, -np.inf)
    for phi in np.linspace(-1.4, 1.4, 6001):
        moved = tool + np.array([[r * phi], [r]])
        cos, sin = np.cos(phi), np.sin(phi)
        turned = np.array([cos * moved[0] - sin * moved[1], sin * moved[0] + cos * moved[1]])
        radius, angle = polar(turned)
        order = np.argsort(radius)
        # the outline of the tool crosses a circle at most twice: take the larger angle
        inside = (radius >= edges[0]) & (radius <= edges[-1])
        index = np.clip(np.searchsorted(edges, radius[order]) - 1, 0, len(furthest) - 1)
        np.maximum.at(furthest, index[inside[order]], angle[order][inside[order]])
    alpha_at = np.arccos(min(1.0, base / float(one.tip)))
    at_tip = float(one.involute(one.tip))
    root = at_tip - (np.tan(alpha_at) - alpha_at)
    return edges, furthest - root


def exact_profile(one: Gear) -> tuple[Floats, Floats]:
    """The same from the offset of the trochoid and the involute, in fine steps."""
    x, depth = one.tool_centre()
    r, base, form = float(one.reference), float(one.base), float(one.form())
    bottom = float(-x / one.reference)
    end = bottom + float(depth) / np.tan(ALPHA) / r
    phi = np.linspace(bottom, end, 20001)
    turn = np.exp(1j * phi)
    at = float(x) + r * phi + 1j * (r - float(depth))
    centre, rate = at * turn, (r + 1j * at) * turn
    point = centre - M * one.rack[2] * 1j * rate / np.abs(rate)
    root = float(one.involute(one.tip)) - float(inv(mp.acos(one.base / one.tip)))
    radii, angles = np.abs(point), np.angle(1j * np.conj(point)) - root
    kept = radii < form
    above = np.linspace(form, float(one.tip), 20001)
    alpha = np.arccos(base / above)
    return (
        np.concatenate([radii[kept], above]),
        np.concatenate([angles[kept], np.tan(alpha) - alpha]),
    )


@pytest.mark.parametrize("teeth", [8, 12, 15])
def test_the_rack_in_small_steps_leaves_the_same_profile(teeth: int) -> None:
    """In each ring between two radii the tool cuts as far as the exact profile allows there."""
    one = Gear(teeth)
    edges, cut = cut_profile(one)
    exact = np.interp(edges, *exact_profile(one))
    furthest = np.maximum(exact[1:], exact[:-1])
    missing = edges[1:] * (furthest - cut)
    within = edges[1:] < 0.99 * float(one.tip)  # the tool's flank ends
    step = 1e-4 * M  # what rotations and points of the tool leave
    assert missing[within].min() > -step
    ring = edges[1:] * abs(np.diff(exact))
    assert (missing - ring)[within].max() < 10 * step


def tip_outline(mate: Gear) -> Floats:
    """Points of the mate's tip, from the end of its involute to the tip circle.

    Its axis is the origin and its tooth points down, with the root of its involute on the y axis:
    the flank faces +x.
    """
    base, rounding = float(mate.base), mate.rounding
    rho = float(tip_curvature(mate))
    roll = rho / base
    foot = base * np.array([-np.sin(roll), -np.cos(roll)])
    tangent = np.array([np.cos(roll), -np.sin(roll)])
    if rounding <= 0:
        return (foot + rho * tangent)[:, None]
    centre = foot + (rho - rounding) * tangent
    to_end, to_tip = (np.arctan2(way[0], -way[1]) for way in (tangent, centre))
    turn = np.linspace(to_end, to_tip, 400)
    return np.array(centre[:, None] + rounding * np.array([np.sin(turn), -np.cos(turn)]))


def smallest_gap(one: Gear, mate: Gear, distance: float, alpha_w: float) -> float:
    """Move the mate over the gear: the smallest arc between its tip and the gear's tooth."""
    radii, tooth = exact_profile(one)
    outline = tip_outline(mate)
    involute = np.tan(alpha_w) - alpha_w
    smallest = np.inf
    for beta in np.linspace(-1.5 / mate.teeth**0.5, 1.5 / mate.teeth**0.5, 20001):
        # both flanks pass the pitch point at beta = 0; a point at +x goes to the middle with beta
        cos, sin = np.cos(beta + involute), np.sin(beta + involute)
        x = cos * outline[0] - sin * outline[1]
        y = distance + sin * outline[0] + cos * outline[1]
        radius, angle = polar(np.array([x, y]))
        inside = (radius < radii[-1]) & (radius > radii[0])
        if inside.any():
            root = mate.teeth / one.teeth * beta - involute
            own = np.interp(radius[inside], radii, tooth) + root
            smallest = min(smallest, float((radius[inside] * (own - angle[inside])).min()))
    return smallest


@pytest.mark.parametrize(
    ("one", "mate"),
    [
        (Gear(12), Gear(30)),
        (Gear(12), Gear(12)),
        (Gear(15), Gear(40)),
        (Gear(10), Gear(80)),
        (Gear(9, rack=(1.0, 1.25, 0.1)), Gear(60, rack=(1.2, 1.25, 0.38))),
        (Gear(12), Gear(40, rack=(1.24, 1.25, 0.38))),
        (Gear(12), Gear(40, rounding=0.0003, rack=(1.24, 1.25, 0.38))),
        (Gear(14), Gear(120, rounding=0.0001, rack=(1.24, 1.25, 0.38))),
    ],
)
def test_the_gap_of_tips_is_that_of_a_mate_that_moves_over_the_gear(
    kernel: Kernel, one: Gear, mate: Gear
) -> None:
    a, b = one.of_kernel(kernel), mate.of_kernel(kernel)
    mesh = mesh_geometry(kernel, a, b, M * (one.teeth + mate.teeth) / 2)
    assert mesh.rho_end_b != mesh.rho_tip_b, "the path is not shortened"
    gap = tip_gap(kernel, a, b, mesh.centre_distance, mesh.working_pressure_angle, mesh.rho_tip_b)
    moved = smallest_gap(one, mate, mesh.centre_distance, mesh.working_pressure_angle)
    assert gap == pytest.approx(moved, abs=1e-5 * M)  # the steps of the mate and of the profile
