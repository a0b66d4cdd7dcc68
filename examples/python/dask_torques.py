"""A case under many torques on the workers of a Dask cluster: the histories never touch a disk.

usage: python dask_torques.py [CASE.yaml] [SCHEDULER]
needs: pip install distributed; workers with evolvent

Without a scheduler two worker processes begin on this machine, and end with this program.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import xarray as xr
from distributed import Client, LocalCluster

import evolvent

TORQUES = -np.linspace(1, 4, 4)  # [N m]


def largest_force(case: str, torque: float) -> float:
    """Run the case's text on a worker: it needs no file there. What comes back is a number."""
    settings = {"wheels.pinion.loads.0.value": torque, "simulation.duration": 0.5}
    return float(evolvent.run(case, settings).normal_force.max())


def main() -> None:
    """Print a line for each torque."""
    examples = Path(__file__).resolve().parents[1]
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else examples / "paper.yaml"
    case = path.read_text(encoding="utf-8")
    if len(sys.argv) > 2:
        client = Client(sys.argv[2])
    else:
        client = Client(LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None))
    with client:
        tasks = client.map(lambda torque: largest_force(case, torque), TORQUES.tolist())
        forces = xr.DataArray(client.gather(tasks), coords={"torque": TORQUES})
    if isinstance(client.cluster, LocalCluster):
        client.cluster.close()
    for torque, force in zip(TORQUES, forces.values, strict=True):
        print(f"{-torque:g} N m: {force:.3f} N")


if __name__ == "__main__":
    main()
