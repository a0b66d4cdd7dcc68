"""K_V by method B of ISO 6336-1: a printed example, joints of its zones."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.kernel import Kernel


def factor(kernel: Kernel, n: float, w: float, e: float, *terms: float) -> float:
    """K_V at N, w [N/mm], contact ratio and B_p, B_f, B_k."""
    return float(kernel.library.test_dynamic_factor(n, w * 1e3, e, *terms))


def test_the_printed_example_of_iso_tr_6336_30_has_its_dynamic_factor(kernel: Kernel) -> None:
    """Example 1: helical, case-hardened, class 5, tip relief; K_v 1.003 is printed."""
    z, m_n, beta, width = (17, 103), 8e-3, np.radians(15.8), 0.1
    single, mesh, w = 12.3707, 17.4692, 127352 / 100  # N/(mm um), N/(mm um), N/mm
    alpha_t = np.arctan(np.tan(np.radians(20)) / np.cos(beta))
    reference = np.array(z) * m_n / np.cos(beta)
    base = reference * np.cos(alpha_t)
    # tip and root diameters of the rack without tip alteration, dedendum 1.4; solid discs
    shift = np.array([0.145, 0.0])
    middle = reference + m_n * (2 * shift + 1 - 1.4)
    inertia = 7830 * width * np.pi / 32 * middle**4
    ratio = (mesh / single - 0.25) / 0.75
    call = kernel.library.test_resonance
    resonance = call(single * 1e9, ratio, width, inertia, base / 2, z[0])
    n = 360 * np.pi / 30 / resonance
    d_mm, m_mm = reference[1] * 1e3, m_n * 1e3
    pitch = round(0.001 * d_mm + 0.4 * m_mm + 5, 0) * np.cos(alpha_t)
    form = round(2 * (0.55 * m_mm + 5)) / 2
    pitch, form = (f - min(0.075 * f, 3.0) for f in (pitch, form))
    overlap = width * np.sin(beta) / (np.pi * m_n)
    terms = (single * pitch / w, single * form / w, abs(1 - single * 70 / w))
    found = factor(kernel, n, w, ratio + overlap, *terms)
    assert round(found, 3) == 1.003


def test_the_factor_without_deviations_is_that_of_the_coefficients_alone(kernel: Kernel) -> None:
    assert factor(kernel, 0.1, 500, 1.5, 0, 0, 1) == pytest.approx(1 + 0.1 * 0.23, rel=1e-14)
    assert factor(kernel, 1.0, 500, 1.5, 0, 0, 1) == pytest.approx(1.9, rel=1e-14)
    assert factor(kernel, 2.0, 500, 1.5, 0, 0, 1) == pytest.approx(0.75, rel=1e-14)
    between = 0.75 + (1.9 - 0.75) * (1.5 - 1.325) / 0.35
    assert factor(kernel, 1.325, 500, 1.5, 0, 0, 1) == pytest.approx(between, rel=1e-14)


@pytest.mark.parametrize("e", [1.2, 1.8, 2.0, 2.2, 2.7])
def test_the_zones_above_resonance_join_without_a_step(kernel: Kernel, e: float) -> None:
    for border in (1.15, 1.5):
        low, high = (factor(kernel, border + d, 300, e, 0.3, 0.2, 0.6) for d in (-1e-9, 1e-9))
        assert low == pytest.approx(high, rel=1e-7)


def test_the_resonance_zone_begins_earlier_at_low_loads(kernel: Kernel) -> None:
    start = 0.5 + 0.35 * np.sqrt(0.25)  # 25 N/mm
    below, above = (factor(kernel, start + d, 25, 1.5, 0, 0, 1) for d in (-1e-9, 1e-9))
    assert below == pytest.approx(1 + start * 0.23, rel=1e-6)
    assert above == pytest.approx(1.9, rel=1e-9)
    assert factor(kernel, 0.849, 100, 1.5, 0, 0, 1) == pytest.approx(1 + 0.849 * 0.23, rel=1e-9)


def test_the_coefficients_of_high_contact_ratios_join_those_below_two(kernel: Kernel) -> None:
    """The standard rounds to two digits, except for C_v4, which steps from 0.90 to 0.839."""
    terms = (0.3, 0.2, 0.6)
    for n in (0.5, 2.0):
        low, high = (factor(kernel, n, 300, e, *terms) for e in (2.0, 2.0 + 1e-9))
        assert low == pytest.approx(high, rel=0.01)
    low, high = (factor(kernel, 1.0, 300, e, *terms) for e in (2.0, 2.0 + 1e-9))
    step = 0.2 * (0.34 - 0.57 / 1.7) + 0.6 * (0.90 - 0.47 / 0.56)
    assert low - high == pytest.approx(step, rel=1e-6)
