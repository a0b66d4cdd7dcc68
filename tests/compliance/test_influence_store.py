"""What is kept of wheels: equal ones are computed once, others never taken for them."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import OF_COMPLIANCE, WHEEL, Gearbox, GearboxError
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.gears import gear_description
from kernel.kernel import STORE_FAILED, Kernel
from kernel.wheel_store import WheelStore

# cheap: elements of order 4
ELEMENTS = {"model": "finite_elements", "state": "plane_strain", "order": 4}


def pair(
    kernel: Kernel,
    store: WheelStore | None = None,
    *,
    teeth: tuple[int, int] = (25, 25),
    module: float = 0.002,
    hub: float = 7.0,
    block: dict[str, object] | None = None,
    steel: dict[str, float] | None = None,
    **given: float,
) -> Gearbox:
    """Two wheels that give way; hub radius in modules."""
    given_block = {**ELEMENTS, "hub_diameter": 2 * hub * module, **(block or {})}
    compliance = Block({key: value for key, value in given_block.items() if value is not None})
    wheels = [
        wheel(
            teeth=z,
            centre=(0.0, 0.0) if i == 0 else None,
            gear=gear_description(module, compliance=compliance, **given),
            **(steel or {}),
        )
        for i, z in enumerate(teeth)
    ]
    meshing = mesh(kernel, real=True)
    return Gearbox(kernel, wheels, (load(0, TORQUE, -50.0),), [meshing], store=store)


def stiffness(gearbox: Gearbox) -> dict[str, object]:
    """All that a mesh tells of its compliance."""
    reported = gearbox.quantities(OF_COMPLIANCE, 0)
    assert len(reported) > 5
    return reported


@pytest.mark.parametrize("teeth", [(25, 25), (25, 30)])
def test_a_store_changes_no_bit_and_each_wheel_is_computed_once(
    kernel: Kernel, teeth: tuple[int, int]
) -> None:
    store = WheelStore()
    alone = stiffness(pair(kernel, teeth=teeth))
    for _ in range(3):
        assert stiffness(pair(kernel, store, teeth=teeth)) == alone
    assert stiffness(pair(kernel, store, teeth=teeth[::-1])) != {}
    assert store.computed == len(set(teeth))
    assert store.asked == 8


# what is changed, and how many wheels are computed for it beside the one that is known
CHANGES: dict[str, tuple[dict[str, object], int]] = {
    "teeth": ({"teeth": (26, 26)}, 1),
    "one wheel's teeth": ({"teeth": (25, 26)}, 1),
    "hub": ({"hub": 7.0 * (1 + 1e-15)}, 1),
    "pressure angle": ({"pressure_angle": 0.35}, 1),
    "profile shift": ({"profile_shift": 0.1}, 1),
    "thickness allowance": ({"thickness_allowance": -1e-5}, 1),
    "tip": ({"tip_diameter": 0.0535}, 1),
    "rack's dedendum": ({"rack_dedendum": 1.2}, 1),
    "rack's rounding": ({"rack_root_radius": 0.3}, 1),
    "Poisson's ratio": ({"steel": {"poisson_ratio": 0.29}}, 1),
    "state": ({"block": {"state": "plane_stress"}}, 1),
    "order": ({"block": {"order": 5}}, 1),
    "module, scaled by a power of 2": ({"module": 0.004}, 0),
    "modulus": ({"steel": {"youngs_modulus": 1e11}}, 0),
    "density": ({"steel": {"density": 1e3}}, 0),
    "formulas": ({"block": {"model": "analytic", "order": None}}, 0),
}


@pytest.mark.parametrize(("change", "computed"), CHANGES.values(), ids=CHANGES)
def test_all_that_decides_makes_another_wheel_and_nothing_else_does(
    kernel: Kernel, change: dict[str, object], computed: int
) -> None:
    store = WheelStore()
    pair(kernel, store)
    assert store.computed == 1
    with_store = stiffness(pair(kernel, store, **change))  # type: ignore[arg-type]
    assert store.computed == 1 + computed
    assert with_store == stiffness(pair(kernel, **change))  # type: ignore[arg-type]


@pytest.mark.parametrize("module", [0.001, 0.003, 0.0045, 0.007])
def test_a_wheel_of_another_module_has_its_own_bits_in_any_order(
    kernel: Kernel, module: float
) -> None:
    """The outline in modules may round otherwise: then it is another wheel."""
    store = WheelStore()
    pair(kernel, store, module=0.002)
    after = stiffness(pair(kernel, store, module=module))
    assert after == stiffness(pair(kernel, module=module))


def test_what_the_store_gives_is_what_counts(kernel: Kernel) -> None:
    """Also at once, where it puts other numbers in place of those that were computed."""

    def soften(numbers: np.ndarray) -> None:
        numbers[17:34] *= 1.5  # E c

    altered = WheelStore(alter=soften)
    first = stiffness(pair(kernel, altered))
    assert altered.computed == 1
    assert stiffness(pair(kernel, altered)) == first
    plain = stiffness(pair(kernel))
    changed = {name for name in plain if plain[name] != first[name]}
    assert {"single_pair", "double_pair", "driving_at_pitch_point"} <= changed
    assert "iso_6336" not in changed


@pytest.mark.parametrize("knows", [False, True])
def test_a_store_that_fails_ends_the_creation(kernel: Kernel, *, knows: bool) -> None:
    """Where it looks for a wheel, and where it takes one."""
    store = WheelStore(answer=-1)
    if knows:
        store.find = type(store.find)(lambda *_: 0)
    with pytest.raises(GearboxError, match="stored compliances of wheels") as caught:
        pair(kernel, store)
    assert (caught.value.code, caught.value.subject) == (STORE_FAILED, WHEEL)
    assert store.computed == knows
