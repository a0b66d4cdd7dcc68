"""Influence functions of the root stress from the library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import evolvent
from evolvent.library.cases import opened
from evolvent.library.root_influence import RootInfluence
from evolvent.physics.load_spectrum import FINE_ARCS, fillet_points
from evolvent.physics.static_root_stress import LOADED, OTHER, tooth_root_stress

MODULE = 3e-3  # m


def test_the_extremes_over_the_arc_are_those_of_show(examples: Path, library: Path) -> None:
    case = examples / "compliant-pair.yaml"
    shown = evolvent.show(case)["root_stress"]["pinion-gear"]
    with opened(case, None) as handle:
        for wheel, side in enumerate(("driving", "driven")):
            influence = RootInfluence(handle, case, wheel)
            rho = shown[side]["load_position"]
            right, left = influence.stress([0], [rho], [0])[0]
            weights = fillet_points(influence.arcs, FINE_ARCS)[1]
            tension = MODULE * (right @ weights).max()
            compression = MODULE * (left @ weights).min()
            assert tension == pytest.approx(shown[side]["tension_coefficient"], rel=1e-5)
            assert compression == pytest.approx(shown[side]["compression_coefficient"], rel=1e-5)


def test_a_load_on_the_left_flank_is_the_mirror_image(examples: Path, library: Path) -> None:
    case = examples / "compliant-pair.yaml"
    teeth = np.arange(-3, 4)
    with opened(case, None) as handle:
        influence = RootInfluence(handle, case, 0)
        rho = np.full(teeth.size, 0.014)
        right = influence.stress(np.zeros(teeth.size), rho, teeth)
        left = influence.stress(np.ones(teeth.size), rho, -teeth)
        around = influence.stress(np.zeros(teeth.size), rho, teeth + 19)
    assert (right[:, ::-1] == left).all()
    assert (right == around).all()


def test_wheels_without_finite_elements_are_refused(examples: Path, library: Path) -> None:
    case = examples / "compliant-pair.yaml"
    with opened(case, {"wheels.gear.compliance": "{model: analytic}"}) as handle:
        with pytest.raises(evolvent.AnalysisError, match="'gear' has no finite elements") as error:
            RootInfluence(handle, case, 1)
        assert error.value.code == 2
        with pytest.raises(evolvent.AnalysisError, match="there is no wheel 2; the case has 0 to"):
            RootInfluence(handle, case, 2)


@pytest.mark.parametrize("sense", [1, -1], ids=["drive flanks", "coast flanks"])
def test_the_stress_of_a_tooth_over_its_positions_has_the_extremes_of_static(
    examples: Path, library: Path, sense: int
) -> None:
    """At each position the extremes of all teeth are those of the tooth in its later pitches."""
    case = examples / "compliant-pair.yaml"
    torques = (60.0, 100.0, 2) if sense > 0 else (-100.0, -60.0, 2)
    static = evolvent.static(case, torque=torques, points=40)
    largest = int(np.abs(static["torque"].values).argmax())
    found = tooth_root_stress(static, largest)
    assert [tooth.wheel for tooth in found] == ["pinion", "gear"]
    for side, tooth in enumerate(found):
        stress = tooth.stress.reshape(static.sizes["pair"], 40, 2, -1)
        for name, values in (
            ("root_stress_max", stress[:, :, LOADED].max(axis=(0, 2))),
            ("root_stress_min", stress[:, :, OTHER].min(axis=(0, 2))),
        ):
            expected = static[name].isel(torque=largest, wheel=side).values
            assert values == pytest.approx(expected, rel=2e-4), (tooth.wheel, name)
