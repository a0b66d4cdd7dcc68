"""Distance of a start from the steady motion."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import STEADY
from kernel.kernel import Kernel
from kernel.shaft_cases import two_stages

Complex = NDArray[np.complex128]


def distance(gearbox: Gearbox, start: State) -> tuple[Complex, Complex]:
    """Eigenvalues of the modes [modes], and their shares of the distance [states, modes]."""
    n = gearbox.sizes.n_states
    at = start.copy()
    eigenvalues, amplitudes = np.zeros(2 * n), np.zeros(2 * n)
    vectors = np.zeros(2 * n * n)
    n_modes = ctypes.c_int()
    gearbox.call(
        "evl_gearbox_start_distance",
        *(gearbox.handle, start.t, start.y, start.integers, at.y, at.integers, at.reals),
        *(ctypes.byref(n_modes), eigenvalues, vectors, amplitudes),
    )
    shapes = vectors.view(complex).reshape(n, n).T[:, : n_modes.value]
    order = np.lexsort((eigenvalues.view(complex)[: n_modes.value].imag,))
    values = eigenvalues.view(complex)[: n_modes.value]
    return values[order], (shapes * amplitudes.view(complex)[: n_modes.value])[:, order]


def test_the_order_of_the_meshes_does_not_matter(kernel: Kernel) -> None:
    """Two meshes of different frequency; the motion is the response to the pitch of one of them."""
    found = []
    for second_first in (False, True):
        gearbox = two_stages(kernel, second_first=second_first)
        start = gearbox.start(STEADY)
        start.y[[gearbox.index(name) for name in gearbox.names if "speed" in name]] += 1e-3
        found.append((gearbox.names, *distance(gearbox, start)))
    (names, values, shares), (other_names, other_values, other_shares) = found
    assert names == other_names
    assert len(values) > 4
    np.testing.assert_allclose(values, other_values, rtol=1e-6, atol=1e-6 * abs(values).max())
    size = np.maximum(abs(shares).max(axis=1, keepdims=True), 1e-300)
    np.testing.assert_allclose(shares / size, other_shares / size, atol=1e-6)
