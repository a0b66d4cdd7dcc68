"""ISO 21771 and ISO 53 in mpmath: the formulas as printed there, independent of the kernel."""

from __future__ import annotations

from typing import Any

import mpmath as mp

from kernel.description import Block
from kernel.gears import GearGeometry


def inv(alpha: mp.mpf) -> mp.mpf:
    """Involute function."""
    return mp.tan(alpha) - alpha


def inverse_inv(involute: mp.mpf) -> mp.mpf:
    """Angle of an involute, by bisection of tan alpha."""
    low, high = mp.mpf(0), involute + 2
    for _ in range(int(4 * mp.mp.dps)):
        middle = (low + high) / 2
        if middle - mp.atan(middle) < involute:
            low = middle
        else:
            high = middle
    return mp.atan((low + high) / 2)


def exact_gear(teeth: int, given: Block) -> dict[str, mp.mpf]:
    """All quantities of a gear without undercut."""
    m, alpha = mp.mpf(given.module), mp.mpf(given.pressure_angle)
    x, allowance = mp.mpf(given.profile_shift), mp.mpf(given.thickness_allowance)
    r = m * teeth / 2
    rb = r * mp.cos(alpha)
    x_e = x + allowance / (2 * m * mp.tan(alpha))
    rf = r - m * (mp.mpf(given.rack.dedendum) - x_e)
    k = mp.mpf(given.get("tip_alteration", 0))
    ra = r + m * (x + mp.mpf(given.rack.addendum) + k)
    if "tip_diameter" in given:
        ra = mp.mpf(given.tip_diameter) / 2
        k = (ra - r) / m - x - mp.mpf(given.rack.addendum)
    rt = mp.mpf(given.get("tip_rounding", 0))
    s = m * (mp.pi / 2 + 2 * x * mp.tan(alpha)) + allowance
    # end of the rack's straight flank in modules below its datum line
    flank = mp.mpf(given.rack.dedendum) - mp.mpf(given.rack.root_radius) * (1 - mp.sin(alpha))
    form = r * mp.sin(alpha) - m * (flank - x_e) / mp.sin(alpha)
    return {
        "pitch": mp.pi * m,
        "base_pitch": mp.pi * m * mp.cos(alpha),
        "generating_shift": x_e,
        "undercut_shift": flank - mp.mpf(teeth) / 2 * mp.sin(alpha) ** 2,
        "tip_alteration": k,
        "reference_radius": r,
        "base_radius": rb,
        "tip_radius": ra,
        "tip_form_radius": mp.sqrt(rb**2 + tip_curvature(ra, rt, rb) ** 2),
        "root_radius": rf,
        "form_radius": mp.sqrt(rb**2 + form**2),
        "tooth_depth": ra - rf,
        "thickness": s,
        "tip_thickness": ra * (s / r + 2 * inv(alpha) - 2 * inv(mp.acos(rb / ra))),
        "tooth_angle": s / r + 2 * inv(alpha),
    }


def tip_curvature(ra: mp.mpf, rt: mp.mpf, rb: mp.mpf) -> mp.mpf:
    """Radius of curvature at the junction of involute and tip rounding: there both normals
    coincide, rt beyond the centre of the rounding.
    """
    return rt + mp.sqrt((ra - rt) ** 2 - rb**2)


def exact_mesh(
    a: GearGeometry, b: GearGeometry, given: dict[str, Any] | None = None
) -> dict[str, mp.mpf]:
    """All quantities of a mesh of two gears of one module, from z, m, alpha, x, A_s and r_a."""
    given = given or {}
    z1, z2 = a.teeth, b.teeth
    m, alpha = mp.mpf(a.normal_module), mp.mpf(a.pressure_angle)
    x_sum = mp.mpf(a.profile_shift) + mp.mpf(b.profile_shift)
    allowances = -(mp.mpf(a.thickness_allowance) + mp.mpf(b.thickness_allowance))
    tight = inv(alpha) + 2 * mp.tan(alpha) * x_sum / (z1 + z2)
    reference = m * (z1 + z2) / 2
    base_sum = reference * mp.cos(alpha)
    tight_distance = base_sum / mp.cos(inverse_inv(tight))
    if "centre_distance" in given:
        distance = mp.mpf(given["centre_distance"])
        working = mp.acos(base_sum / distance)
        backlash = 2 * base_sum * (inv(working) - tight) + allowances * mp.cos(alpha)
    else:
        backlash = mp.mpf(given.get("backlash", 0))
        if "backlash" not in given:
            backlash = allowances * mp.cos(alpha)
        working = inverse_inv(tight + (backlash - allowances * mp.cos(alpha)) / (2 * base_sum))
        distance = base_sum / mp.cos(working)
    rb1, rb2 = m * z1 / 2 * mp.cos(alpha), m * z2 / 2 * mp.cos(alpha)
    ra1, ra2 = mp.mpf(a.tip_radius), mp.mpf(b.tip_radius)
    t1t2 = distance * mp.sin(working)
    long1 = 2 * tip_curvature(ra1, mp.mpf(a.tip_rounding), rb1)
    long2 = 2 * tip_curvature(ra2, mp.mpf(b.tip_rounding), rb2)
    path = (long1 + long2) / 2 - t1t2
    rw1, rw2 = distance * z1 / (z1 + z2), distance * z2 / (z1 + z2)
    return {
        "centre_distance": distance,
        "reference_distance": reference,
        "tight_distance": tight_distance,
        "working_pressure_angle": working,
        "pitch_radius_a": rw1,
        "pitch_radius_b": rw2,
        "line_of_action": t1t2,
        "base_pitch": mp.pi * m * mp.cos(alpha),
        "path_of_contact": path,
        "approach": long2 / 2 - rw2 * mp.sin(working),
        "recess": long1 / 2 - rw1 * mp.sin(working),
        "contact_ratio": path / (mp.pi * m * mp.cos(alpha)),
        "rho_tip_a": long1 / 2,
        "rho_tip_b": long2 / 2,
        "active_radius_a": mp.sqrt((2 * t1t2 - long2) ** 2 + 4 * rb1**2) / 2,
        "active_radius_b": mp.sqrt((2 * t1t2 - long1) ** 2 + 4 * rb2**2) / 2,
        "clearance_a": distance - ra2 - mp.mpf(a.root_radius),
        "clearance_b": distance - ra1 - mp.mpf(b.root_radius),
        "backlash": backlash,
        "circumferential_backlash": backlash / mp.cos(working),
        "radial_backlash": backlash / (2 * mp.sin(working)),
    }
