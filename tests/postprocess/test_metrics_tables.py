"""The numbers over whole periods, as a report writes them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.physics.metrics import metrics_tables
from evolvent.units import quantity

ORDERS = np.arange(1, 11)


def reported() -> xr.Dataset:
    """Two meshes with amplitudes of their own, and three wheels of which one rests."""
    names = {"mesh": ["first", "second"], "wheel": ["a", "b", "c"], "harmonic": ORDERS}
    of_mesh, of_wheel = ("mesh", "harmonic"), ("wheel", "axis")
    return xr.Dataset(
        {
            "normal_force": ("mesh", [1.0, 2.0], {"units": "N"}),
            "window_normal_force_mean": ("mesh", [30.0, np.nan], {"units": "N"}),
            "window_dynamic_factor": ("mesh", [np.nan, np.nan]),
            "window_error_phase": (of_mesh, np.ones((2, 10)), {"units": "rad"}),
            "window_error_amplitude": (
                *(of_mesh, np.array([[1e-6], [1e-5]]) / ORDERS),
                {"units": "m", "long_name": "amplitude of the error"},
            ),
            "window_centre_acceleration_rms": (
                *(of_wheel, [[3.0, 4.0], [0.0, np.nan], [0.0, 1.0]]),
                {"units": "m s-2"},
            ),
            "window_angular_acceleration_rms": ("wheel", [0.0, 0.0, 0.0]),
        },
        coords=names,
    )


def test_the_first_five_orders_stand_beside_each_other_from_the_first_on():
    (meshes, rows), _ = metrics_tables(reported())
    assert meshes == ["first", "second"]
    texts = dict(rows)["amplitude of the error, 1 to 5"]
    assert texts == [
        ", ".join(quantity(size / n, "m", 4) for n in range(1, 6)) for size in (1e-6, 1e-5)
    ]


def test_phases_what_is_not_known_and_what_rests_have_no_row():
    (_, of_meshes), (wheels, of_wheels) = metrics_tables(reported())
    assert [label for label, _ in of_meshes] == [
        "window_normal_force_mean",
        "amplitude of the error, 1 to 5",
    ]
    assert dict(of_meshes)["window_normal_force_mean"] == [quantity(30.0, "N", 4), "-"]
    assert wheels == ["a", "b", "c"]
    ((label, texts),) = of_wheels
    assert label == "window_centre_acceleration_rms"
    assert texts[0] == ", ".join(quantity(v, "m s-2", 4) for v in (3.0, 4.0))
    assert texts[1] == f"{quantity(0.0, 'm s-2', 4)}, -"
