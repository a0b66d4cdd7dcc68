"""Root stress of wheels: acceptance values, an independent program, structure, polynomials."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from compliance.bodies import Body, lobatto, straight
from compliance.root_stress import LEFT, RIGHT, Gear
from compliance.test_bodies import arc
from kernel.description import Block, described
from kernel.gears import gear, gear_description
from kernel.kernel import OK, Floats, Kernel, Status, _at, _double
from reference.root_stress_triangles import FRACTIONS, WHEELS, Wheel

# rho [mm], Sigma right max, left min, Y_F Y_S cos(alpha), module 3 mm; z, x, bore [mm]
ACCEPTED = {
    (50, 0.0, 40.0): (
        [19.6162, 23.2999, 26.4759, 29.3098, 31.8928],
        [1.8389, 1.9582, 2.2703, 2.6915, 3.1819],
        [-1.6188, -2.1466, -2.7094, -3.2930, -3.8834],
        [1.1183, 1.7418, 2.3169, 2.8662, 3.4002],
    ),
    (19, 0.4, 25.0): (
        [7.7426, 11.0913, 13.6413, 15.7846, 17.6698],
        [2.0356, 2.0527, 2.2954, 2.6610, 3.1102],
        [-1.7336, -2.2661, -2.8404, -3.4426, -4.0538],
        [1.4931, 1.9911, 2.4881, 2.9713, 3.4420],
    ),
    (40, 0.0, 36.0): (
        [14.7075, 18.4446, 21.5428, 24.2484, 26.6810],
        [1.9197, 2.0416, 2.3449, 2.7535, 3.2310],
        [-1.7139, -2.2373, -2.7932, -3.3702, -3.9565],
        [1.2588, 1.8376, 2.3888, 2.9227, 3.4452],
    ),
}
# right at a fixed arc [modules] under loads on teeth -1 and 1
NEIGHBOURS = {
    (50, 0.0, 40.0): (
        0.2839,
        [0.1569, 0.1470, 0.1408, 0.1357, 0.1306],
        [-0.1456, -0.1323, -0.1135, -0.0929, -0.0721],
    ),
    (19, 0.4, 25.0): (
        0.2986,
        [0.1763, 0.1694, 0.1641, 0.1592, 0.1537],
        [-0.1704, -0.1505, -0.1255, -0.0987, -0.0720],
    ),
}
# z, x, hub radius [modules]: few and many teeth, thick and thin bodies
FORMS = [(12, 0.5, 2.0), (20, 0.0, 7.0), (30, -0.1, 12.4), (25, 0.8, 5.0), (120, 0.3, 20.0)]
# a large hub close to the fillet, whose stress depends most on the width of a low load
FORMS += [(112, 0.22, 52.5)]


def wheel(kernel: Kernel, teeth: int, shift: float, hub: float, order: int = 8) -> Gear:
    """Wheel of module 1 m."""
    return Gear(kernel, gear(kernel, teeth, 1.0, profile_shift=shift), hub, order)


def fine_arcs(found: Gear) -> Floats:
    """Arcs of the fillet that contain its extremes."""
    return np.linspace(0.1, 0.98, 121) * found.fillet(np.zeros(1))[0]


@pytest.mark.parametrize("of", ACCEPTED)
def test_acceptance(kernel: Kernel, of: tuple[int, float, float]) -> None:
    """By the polynomials; the values were computed by two programs that agree to 6e-4."""
    rho, largest, least, nominal = (np.array(row) for row in ACCEPTED[of])
    teeth, shift, bore = of
    geometry = gear(kernel, teeth, 3e-3, profile_shift=shift)
    found = Gear(kernel, geometry, bore / 6)
    stress = found.polynomials(rho[:, None] * 1e-3)
    assert 3e-3 * stress.extremes[:, 0, 0] == pytest.approx(largest, rel=1e-3)
    assert 3e-3 * stress.extremes[:, 1, 1] == pytest.approx(least, rel=1e-3)
    for at, value in zip(rho, nominal, strict=True):
        factors, is_valid = found.nominal(at / 3)
        assert is_valid
        assert factors[3] == pytest.approx(value, abs=1e-4)
        assert factors[0] * factors[1] * np.cos(geometry.pressure_angle) == pytest.approx(
            value, 1e-4
        )


@pytest.mark.parametrize("of", NEIGHBOURS)
def test_neighbours_at_a_fixed_arc(kernel: Kernel, of: tuple[int, float, float]) -> None:
    """The sense of j: tension from tooth -1, compression from tooth 1."""
    at, *rows = NEIGHBOURS[of]
    teeth, shift, bore = of
    found = Gear(kernel, gear(kernel, teeth, 3e-3, profile_shift=shift), bore / 6)
    rho = np.array(ACCEPTED[of][0])[:, None] * 1e-3
    for j, row in zip((-1, 1), rows, strict=True):
        stress = found.polynomials(rho, tooth=j, arc=3e-3 * at)
        # 1e-3 of the stress of the own tooth
        assert 3e-3 * stress.at_arc[:, 0] == pytest.approx(row, abs=3e-4)


def test_tip_load_of_the_nominal_stress(kernel: Kernel) -> None:
    """Y_F and Y_S of ISO 6336-3 as in textbooks: 2.32, 1.70; 2.40, 1.67."""
    for teeth, printed in ((50, (2.32, 1.70)), (40, (2.40, 1.67))):
        geometry = gear(kernel, teeth, 1.0)
        rho = np.sqrt(geometry.tip_radius**2 - geometry.base_radius**2)
        factors, is_valid = wheel(kernel, teeth, 0.0, 5.0).nominal(rho)
        assert is_valid
        assert factors[:2] == pytest.approx(printed, abs=0.014)
    # a rack with a nearly sharp corner cuts a notch outside the range of Y_S
    sharp = Gear(kernel, gear(kernel, 300, 1.0, rack_root_radius=0.02), 5.0, rounding=0.02)
    factors, is_valid = sharp.nominal(51.0)
    assert factors[2] > 8
    assert not is_valid


@pytest.mark.parametrize("reference", WHEELS, ids=lambda wheel: str(wheel.teeth))
def test_triangles_of_a_whole_wheel_agree(kernel: Kernel, reference: Wheel) -> None:
    """Along both fillets, and under loads on both neighbours; that program's error is 2e-4."""
    found = wheel(kernel, reference.teeth, reference.shift, reference.hub)
    length = found.fillet(np.zeros(1))[0]
    assert length == pytest.approx(reference.fillet, rel=1e-6)
    stress = found.polynomials(reference.rho[:, None])
    assert stress.extremes[:, 0, 0] == pytest.approx(reference.largest, rel=5e-4)
    assert stress.extremes[:, 1, 1] == pytest.approx(reference.least, rel=5e-4)
    arcs = FRACTIONS * length
    direct = found.elements(arcs, reference.rho)
    largest = np.array(reference.largest)[:, None]
    for row in ("right", "left"):
        values = np.array(getattr(reference, row))
        # 2e-3 is required
        assert np.abs((direct.of(row, 0) - values) / largest).max() < 5e-4
    third = found.polynomials(reference.rho[:, None], arc=arcs[2]).at_arc
    for side, row in enumerate((reference.right, reference.left)):
        assert third[:, side] == pytest.approx(np.array(row)[:, 2], rel=1e-3)
    for j, values in ((-1, reference.previous), (1, reference.following)):
        at_arc = found.polynomials(reference.rho[:, None], tooth=j, arc=reference.fixed).at_arc
        assert at_arc[:, 0] == pytest.approx(values, abs=2e-4)


@pytest.mark.parametrize(("teeth", "shift", "hub"), FORMS)
def test_polynomials_have_the_extremes_of_the_elements(
    kernel: Kernel, teeth: int, shift: float, hub: float
) -> None:
    """At random positions, from end to end, the largest tension and compression to 1e-3."""
    found = wheel(kernel, teeth, shift, hub)
    low, high = found.flank()
    part = np.concatenate([[0.0, 0.01, 0.03, 0.99, 1.0], np.random.default_rng(7).random(12)])
    rho = low + (high - low) * part
    direct = found.elements(fine_arcs(found), rho)
    smooth = found.polynomials(rho[:, None]).extremes
    assert smooth[:, 0, 0] == pytest.approx(direct.of("right", 0).max(axis=1), rel=1e-3)
    assert smooth[:, 1, 1] == pytest.approx(direct.of("left", 0).min(axis=1), rel=1e-3)


@pytest.mark.parametrize(("teeth", "shift", "hub"), FORMS)
def test_polynomials_of_all_teeth_have_the_stress_of_the_elements(
    kernel: Kernel, teeth: int, shift: float, hub: float
) -> None:
    """At every arc, to 1e-3 of the largest stress under a load on the own tooth."""
    found = wheel(kernel, teeth, shift, hub)
    low, high = found.flank()
    rho = low + (high - low) * np.random.default_rng(3).random(6)
    at = found.polynomials([[0.0]]).arcs
    last = teeth // 2
    direct = found.elements(at, rho, last)
    least = direct.of("right", 0).max(axis=1).min()
    teeth_loaded = np.array([j for j in range(-last, last + 1) if j != 0])
    tooth, at_rho = (grid.reshape(-1, 1) for grid in np.meshgrid(teeth_loaded, rho, indexing="ij"))
    smooth = found.polynomials(at_rho, tooth=tooth).values.reshape(-1, len(rho), 2, len(at))
    for k, j in enumerate(teeth_loaded):
        for side, name in enumerate(("right", "left")):
            assert np.abs(smooth[k, :, side] - direct.of(name, j)).max() < 1e-3 * least


def test_loads_beyond_the_polynomials(kernel: Kernel) -> None:
    """Linear up to the ends of the involute, then constant."""
    found = wheel(kernel, 50, 0.0, 20 / 3)
    geometry = found.geometry
    tip, form = (
        np.sqrt(r**2 - geometry.base_radius**2) for r in (geometry.tip_radius, geometry.form_radius)
    )
    near_tip = np.sqrt(tip**2 - 2 * geometry.base_radius * 0.03)
    assert near_tip > found.flank()[1]
    direct = found.elements(fine_arcs(found), np.array([near_tip]))
    smooth = found.polynomials([[near_tip], [tip], [tip + 1], [form - 1], [form - 2]]).extremes
    assert smooth[0, 0, 0] == pytest.approx(direct.of("right", 0).max(), rel=2e-4)
    assert smooth[0, 1, 1] == pytest.approx(direct.of("left", 0).min(), rel=2e-4)
    assert smooth[1, 0, 0] > smooth[0, 0, 0]
    assert np.all(smooth[1] == smooth[2])
    assert np.all(smooth[3] == smooth[4])


@pytest.mark.parametrize(("teeth", "shift", "hub"), [(50, 0.0, 20 / 3), (19, 0.4, 12.5 / 3)])
def test_refined_elements(kernel: Kernel, teeth: int, shift: float, hub: float) -> None:
    """Order 8 against 10, and the step of the stress where two elements meet."""
    found, finer = (wheel(kernel, teeth, shift, hub, order=order) for order in (8, 10))
    low, high = found.flank()
    rho = low + (high - low) * np.array([0.05, 0.2, 0.5, 0.8, 1.0])
    arcs = fine_arcs(found)
    coarse, fine = (form.elements(arcs, rho) for form in (found, finer))
    for name, extreme in (("right", np.max), ("left", np.min)):
        change = extreme(coarse.of(name, 0), axis=1) / extreme(fine.of(name, 0), axis=1) - 1
        assert np.abs(change).max() < 3e-4
    # elements meet in the middle of beta; half of the step is an estimate of the error
    length = found.fillet(np.zeros(1))[0]
    steps = []
    for form in (found, finer):
        at = border(form, length)
        both = form.elements(np.array([at - 1e-9, at + 1e-9]), rho).of("right", 0)
        steps.append((np.abs(both[:, 1] - both[:, 0]) / coarse.of("right", 0).max(axis=1)).max())
    print(f"step between elements, order 8 and 10: {steps[0]:.1e} {steps[1]:.1e}")
    assert steps[0] < 2e-3
    assert steps[1] < steps[0]


def border(found: Gear, length: float) -> float:
    """Arc of the middle element border, where the kernel's beta is half of that at the involute."""
    geometry = found.geometry
    depth = geometry.reference_radius - geometry.root_radius - found.rounding
    ends = np.tan(np.array([1.0, 0.5]) * (np.pi / 2 - geometry.pressure_angle))
    beta, r = np.arctan(ends), geometry.reference_radius
    from_root = found.rounding * (beta + depth / r * ends) + depth**2 / (2 * r) * (
        ends / np.cos(beta) + np.arcsinh(ends)
    )
    assert from_root[0] == pytest.approx(length, rel=1e-12)
    return float(from_root[0] - from_root[1])


def test_arc_of_the_fillet(kernel: Kernel) -> None:
    """The closed form against the length of a polygon through points of the outline."""
    for teeth, shift, rounding in (
        (50, 0.0, 0.38),
        (12, 0.5, 0.3),
        (25, 0.8, 0.38),
        (80, 1.0, 0.2),
    ):
        geometry = gear(kernel, teeth, 1.0, profile_shift=shift, rack_root_radius=rounding)
        found = Gear(kernel, geometry, 4.0, rounding=rounding)
        length = found.fillet(np.zeros(1))[0]
        points = found.fillet(np.linspace(0, length, 20001))[1]
        chords = np.hypot(*np.diff(points, axis=0).T)
        assert chords == pytest.approx(length / 20000, rel=1e-5)


@pytest.mark.parametrize("stress", [False, True])
def test_bar_under_tension(kernel: Kernel, stress: bool) -> None:
    """Any side of a body under a uniform tension: the stress is that tension times the cosine."""
    p, nu, pull = 8, 0.3, 0.7
    x = lobatto(kernel, p)[0]
    t = (1 + x) / 2
    # lateral strain over stress: nu/(1 - nu) of the axial one in plane strain
    lateral = nu if stress else nu / (1 - nu)
    plane_modulus = 1.0 if stress else 1 / (1 - nu**2)
    strain = pull / plane_modulus * np.array([1.0, -lateral])
    for angle in (0.0, 0.4, 1.1):
        # a straight side, whose nodes are where a cubic has them; plus a rotation of the body
        along = (t + 0.1 * t * (1 - t))[:, None]
        points = along * np.array([np.cos(angle), np.sin(angle)]) + [0.2, -0.3]
        moved = points * strain + 0.05 * points[:, ::-1] * [-1, 1]
        points, moved = np.ascontiguousarray(points), np.ascontiguousarray(moved)
        found = [
            kernel.library.test_edge_stress(
                p, _at(points), _at(moved), _double(at), _double(nu), int(stress)
            )
            for at in (-1.0, -0.3, 0.5, 1.0)
        ]
        exact = pull * (np.cos(angle) ** 2 - lateral * np.sin(angle) ** 2)
        assert found == pytest.approx([exact] * 4, abs=1e-13)


def test_ring_under_torque(kernel: Kernel) -> None:
    """The rim under uniform shear: no tangential stress, from the displacements of the elements."""
    hub, rim, p = 1.0, 2.5, 10
    body = Body(kernel, p)
    for ring in range(4):
        low, high = (hub * (rim / hub) ** (f / 4) for f in (3 - ring, 4 - ring))
        radial = [straight(*(r * np.array(to) for r in (low, high))) for to in ((1, 0), (0, 1))]
        arcs = [arc(r, 0, np.pi / 2) for r in (low, high)]
        body.patch([radial[0], arcs[1], radial[1], arcs[0]], 1, 4, ring + 1)
    at = body.points()
    radius = np.hypot(*at.T)
    ends = np.concatenate(
        [2 * np.flatnonzero(at[:, 1] < 1e-12), 2 * np.flatnonzero(at[:, 0] < 1e-12) + 1]
    )
    held = np.flatnonzero(radius < hub + 1e-9)
    fixed = np.concatenate([ends, 2 * held, 2 * held + 1])
    _, w, _ = lobatto(kernel, p)
    load = np.zeros(len(at) * 2)
    sides, _ = body.nodes()
    for nodes in sides[:4, 1]:
        share = w * rim * np.pi / 16
        load[2 * nodes] -= share * at[nodes, 1] / rim
        load[2 * nodes + 1] += share * at[nodes, 0] / rim
    outer = np.setdiff1d(
        (2 * np.unique(sides[:4, 1])[:, None] + np.arange(2)).ravel(), fixed
    ).astype(np.int32)
    condensed = body.condensed(fixed, outer, load)
    u = np.zeros(len(at) * 2)
    u[outer] = np.linalg.solve(condensed[:-1, :-1], condensed[:-1, -1])
    assert np.abs(u[outer]).max() > 1
    for nodes in sides[:4, 1]:
        points, moved = (
            np.ascontiguousarray(at[nodes]),
            np.ascontiguousarray(u.reshape(-1, 2)[nodes]),
        )
        for local in (-1.0, -0.4, 0.7):
            stress = kernel.library.test_edge_stress(
                p, _at(points), _at(moved), _double(local), _double(0.3), 0
            )
            assert abs(stress) < 1e-8  # beside a shear of 1


@pytest.mark.parametrize("teeth", [12, 19])
def test_a_wheel_has_the_period_of_its_teeth(kernel: Kernel, teeth: int) -> None:
    """Load on tooth j is load on tooth j - z, for the elements and the polynomials."""
    found = wheel(kernel, teeth, 0.4, 2.5)
    arcs, rho = fine_arcs(found)[::12], np.array([3.0, 4.5])
    direct = found.elements(arcs, rho, teeth)
    for j in range(1, teeth):
        for name in ("right", "left"):
            assert np.abs(direct.of(name, j) - direct.of(name, j - teeth)).max() < 1e-12
            assert np.abs(direct.of(name, j)).max() > 1e-4
    tooth = np.arange(-3 * teeth, 4 * teeth)
    values = found.polynomials(np.full((len(tooth), 1), 4.1), tooth=tooth[:, None]).values
    assert np.all(values[:-teeth] == values[teeth:])


def test_mirrored_flank(kernel: Kernel) -> None:
    """A load on the left flank of tooth j is that on the right flank of tooth -j, mirrored."""
    found = wheel(kernel, 19, 0.4, 12.5 / 3)
    tooth = np.array([0, 1, -1, 2, 5, 9, 12])[:, None]
    rho = np.linspace(3.0, 5.0, len(tooth))[:, None]
    right = found.polynomials(rho, tooth=tooth, flank=RIGHT)
    left = found.polynomials(rho, tooth=-tooth, flank=LEFT)
    assert np.all(right.values == left.values[:, ::-1])
    assert np.all(right.extremes == left.extremes[:, ::-1])
    # equal loads on both flanks: both fillets are alike, and less stressed than by one load
    both = found.polynomials([[5.0, 5.0]], flank=[[RIGHT, LEFT]])
    assert np.all(both.values[:, 0] == both.values[:, 1])
    assert np.abs(both.values).max() < np.abs(found.polynomials([[5.0]]).values).max()


def test_superposition(kernel: Kernel) -> None:
    """The stress of several pairs is that of the elements, summed."""
    found = wheel(kernel, 50, 0.0, 20 / 3)
    rho, tooth = np.array([7.0, 9.9, 8.1]), np.array([0, 1, -1])
    force = np.array([120.0, 90.0, 55.0])
    arcs = fine_arcs(found)
    direct = found.elements(arcs, rho, 1)
    total = sum(
        f * direct.of("right", j)[k] for k, (j, f) in enumerate(zip(tooth, force, strict=True))
    )
    extremes = found.polynomials([rho], tooth=[tooth], force=[force]).extremes[0, 0]
    assert extremes[0] == pytest.approx(total.max(), rel=1e-3)
    assert extremes[2] == pytest.approx(arcs[np.argmax(total)], abs=0.01)


def test_module_and_modulus(kernel: Kernel) -> None:
    """Sigma is that of another module; stress over line load has the unit 1/m."""
    large = wheel(kernel, 25, 0.2, 4.0).polynomials([[4.0], [6.0]])
    small = Gear(kernel, gear(kernel, 25, 2e-3, profile_shift=0.2), 4.0)
    scaled = small.polynomials([[8e-3], [12e-3]])
    assert 2e-3 * scaled.values == pytest.approx(large.values, rel=1e-9)
    assert scaled.arcs == pytest.approx(2e-3 * large.arcs, rel=1e-12)


def test_poissons_ratio_and_plane_state(kernel: Kernel) -> None:
    """Poisson's ratio has an influence only through the hub, the more the larger that is."""
    geometry = gear(kernel, 30, 1.0)
    arcs, rho = np.array([0.2, 0.3, 0.4]), np.array([6.0, 7.0])

    def right(hub: float, nu: float, stress: bool) -> Floats:
        return Gear(kernel, geometry, hub, nu=nu, stress=stress).elements(arcs, rho).of("right", 0)

    # plane strain with nu is plane stress with nu/(1 - nu)
    assert right(5.0, 0.3, False) == pytest.approx(right(5.0, 0.3 / 0.7, True), rel=1e-9)
    change = [np.abs(right(r, 0.1, True) / right(r, 0.3, True) - 1).max() for r in (5.0, 12.4)]
    assert change[0] < 5e-4
    assert change[1] > 2 * change[0]


def test_one_store_for_compliance_and_stress(kernel: Kernel) -> None:
    """Both are found again to the bit, and neither is read as the other."""
    form = wheel(kernel, 19, 0.4, 12.5 / 3)
    assert kernel.library.test_common_store(*form.form(), _double(0.3)) == 0


@pytest.mark.parametrize(
    ("block", "like"),
    [
        ({}, {}),
        ({"order": 6, "state": "plane_stress"}, {"order": 6, "stress": True}),
        ({"model": "analytic"}, None),
        ({"model": "none"}, None),
        (None, None),
    ],
)
def test_wheel_of_a_case(
    kernel: Kernel, block: dict[str, object] | None, like: dict[str, object] | None
) -> None:
    """Its hub, state and order; no root stress without finite elements."""
    form = gear_description(3e-3, profile_shift=0.4)
    if block is not None:
        form["compliance"] = Block({"hub_diameter": 25e-3, **block})
        if block.get("model") == "none":
            del form["compliance"]["hub_diameter"]
    case = {
        "materials": {"m": Block(youngs_modulus=2.06e11, poisson_ratio=0.3, density=7850.0)},
        "wheels": [{"name": "w", "material": "m", "width": 1.0, "teeth": 19, **form}],
    }
    extremes, status = np.empty(2), Status()
    with described(kernel.library, case, status) as description:
        assert status.code == OK, status.message
        exists = kernel.library.test_root_stress_of_case(
            description, _double(13.6e-3), _at(extremes), ctypes.byref(status)
        )
    assert status.code == OK, status.message
    assert bool(exists) == (like is not None)
    if like is None:
        assert np.all(extremes == 0)
        return
    found = Gear(kernel, gear(kernel, 19, 3e-3, profile_shift=0.4), 12.5 / 3, **like)
    assert np.all(extremes == found.polynomials([[13.6e-3]]).extremes[0, 0, :2])
