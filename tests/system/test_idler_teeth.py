"""Teeth of an idler defined by a basic rack: the same number of a tooth in both meshes."""

from __future__ import annotations

import numpy as np

from system.cases import STEEL


def test_both_meshes_of_an_idler_give_a_tooth_the_same_number(runs):
    """The middle of a tooth, from its contact position, is at its number times the pitch."""
    gear = {"module": 3e-3, "width": 0.03, "material": "steel"}
    wheels = [{"name": n, "teeth": z, **gear} for n, z in (("a", 23), ("b", 31), ("c", 20))]
    wheels[0] |= {"centre": [0, 0], "loads": [{"kind": "torque", "value": -50}]}
    wheels[2]["loads"] = [{"kind": "viscous", "coefficient": 3}]
    mesh = {"backlash": 5e-5, "damping": {"law": "linear", "coefficient": 1e3}}
    case = {
        **{"format": 1, "materials": {"steel": STEEL}, "wheels": wheels},
        "meshes": [
            {"driving": "a", "driven": "b", "driving_rotation": "clockwise"} | mesh,
            {"driving": "b", "driven": "c", "driving_rotation": "counterclockwise"} | mesh,
        ],
        "simulation": {"duration": 0.02, "output_interval": 1e-3, "initial": {"kind": "steady"}},
    }
    case["meshes"][0]["centre_line_angle"] = 10
    case["meshes"][1]["centre_line_angle"] = -50
    history = runs(case).history
    z, r_b = 31, float(history["base_radius"].sel(wheel="b"))
    thickness = np.pi * 3e-3 / 2
    fills = 2 * thickness / (3e-3 * z) + 2 * (np.tan(np.radians(20)) - np.radians(20))
    origins = []
    for m, side in ((0, "driven"), (1, "driving")):
        sigma = float(history["flank"][m])
        x, y = (history[f"contact_point_{side}"][:, m] - history["centre"].sel(wheel="b")).T.values
        roll = np.arccos(r_b / np.hypot(x, y))
        middle = np.arctan2(y, x) - sigma * (np.tan(roll) - roll) + sigma * fills / 2
        touched = history["pair_tooth_" + side][:, m].values
        number = history["pair_number"][:, m].values == history["tooth_pair"][:, m].values[:, None]
        tooth = touched[np.arange(len(x)), number.argmax(axis=1)]
        angle = middle - tooth * 2 * np.pi / z - history["angle"].sel(wheel="b").values
        origins.append(np.exp(1j * angle))
    # the same tooth 0 at all times and in both meshes, to the penetration over the radius
    np.testing.assert_allclose(origins[0], origins[0][0], atol=1e-4)
    np.testing.assert_allclose(origins[1], origins[0][0], atol=1e-4)
