"""Root stress of one tooth along a quasi-static analysis, at all arcs of its fillets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr

Values = NDArray[np.float64]
ARCS = 97  # points of a fillet
LOADED, OTHER = 0, 1  # fillets: on the side of the loaded flank, and on the other side


@dataclass(frozen=True)
class ToothRootStress:
    """Stress in both fillets of one tooth of a wheel while its pair passes the path of contact."""

    wheel: str
    positions: Values  # of its pair from the start of the path [pitches]
    arcs: Values  # from the form circle [m]
    stress: Values  # shape (positions, 2, arcs), fillets `LOADED` and `OTHER` [Pa]


def tooth_root_stress(static: xr.Dataset, torque: int) -> list[ToothRootStress]:
    """Compute the root stress of tooth pair 0 of both wheels. Equation RS3.

    Parameters
    ----------
    static : with the variables of the tooth pairs, and its case.
    torque : index.

    Returns
    -------
    list of ToothRootStress
        One for each wheel with finite elements.

    Raises
    ------
    AnalysisError
        The library cannot be loaded.
    """
    from evolvent.library.calls import show
    from evolvent.library.cases import opened

    text, mesh = str(static.attrs["case"]), str(static.attrs["mesh"])
    case = show(text)["case"]
    names = [str(wheel["name"]) for wheel in case["wheels"]]
    ends = next(one for one in case["meshes"] if one["name"] == mesh)
    found = []
    with opened(text, None) as handle:
        for side, key in enumerate(("driving", "driven")):
            if static["root_stress_max"].isel(wheel=side, torque=torque).notnull().any():
                wheel = str(ends[key])
                found.append(_of_wheel(static, torque, side, wheel, names.index(wheel), handle))
    return found


def _of_wheel(
    static: xr.Dataset, torque: int, side: int, name: str, index: int, handle: Any
) -> ToothRootStress:
    from evolvent.library.root_influence import RootInfluence
    from evolvent.physics.load_spectrum import fillet_points

    influence = RootInfluence(handle, str(static.attrs["case"]), index)
    arcs, weights = fillet_points(influence.arcs, ARCS)
    points, pitches = int(static.attrs["points"]), int(static.attrs["pitches"])
    # An elder pair is on the tooth ahead in the sense of rotation: on the side of drive flanks of
    # the driving wheel, and of coast flanks of the driven one.
    facing = (1, -1)[side] * int(np.sign(float(static["torque"][torque])))
    force = static["pair_normal_force"].values[torque]
    rho = static[("pair_position", "pair_position_driven")[side]].values[torque]
    ahead = static["pair"].values.astype(int)
    positions, stress = [], []
    for number in ahead:  # pitches of pair 0 since it entered the path
        rows = points * (int(number) % pitches) + np.arange(points)
        row, slot = np.nonzero(force[rows] > 0.0)
        teeth = facing * (ahead[slot] - number)
        at_unit_load = influence.stress(np.zeros(row.size), rho[rows][row, slot], teeth)
        line_load = force[rows][row, slot] / float(static["common_width"])
        sums = np.zeros((points, 2, influence.arcs.size))
        np.add.at(sums, row, line_load[:, None, None] * at_unit_load)
        positions.append(int(number) + np.arange(points) / points)
        stress.append(sums @ weights)
    return ToothRootStress(name, np.concatenate(positions), arcs, np.concatenate(stress))
