"""What decides about the dynamic factor? Sobol's indices by SALib, of runs in threads.

usage: python sobol_indices.py [CASE.yaml] [SAMPLES]
needs: pip install SALib
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from SALib.analyze import sobol as indices
from SALib.sample import sobol as sample

import evolvent

PROBLEM = {
    "num_vars": 3,
    "names": ["torque", "damping", "friction"],
    "bounds": [[50, 150], [0.03, 0.17], [0, 0.1]],
}
RUN = {
    "simulation.duration": 0.02,
    "simulation.metrics": "{from: 0.01}",
    "simulation.accuracy": 1e-6,
    "simulation.outputs": "transmission_error",  # the numbers come all the same
}


def dynamic_factor(case: Path, values: np.ndarray) -> float:
    """Of one sample; the speed stays, as the load goes with the torque."""
    torque, damping, friction = values
    history = evolvent.run(
        case,
        RUN
        | {
            "wheels.pinion.loads.0.value": -torque,
            "wheels.gear.loads.0.coefficient": 0.020386 * torque,
            "meshes.0.damping.value": damping,
            "meshes.0.friction.coefficient": friction,
        },
    )
    return float(history.window_dynamic_factor[0])


def main() -> None:
    """Run all samples, and print the indices."""
    examples = Path(__file__).resolve().parents[1]
    case = Path(sys.argv[1]) if len(sys.argv) > 1 else examples / "spur-pair.yaml"
    samples = sample.sample(PROBLEM, int(sys.argv[2]) if len(sys.argv) > 2 else 64, seed=1)
    with ThreadPoolExecutor(2) as threads:
        factors = np.array(list(threads.map(lambda values: dynamic_factor(case, values), samples)))
    found = indices.analyze(PROBLEM, factors, seed=1)
    print(f"{len(factors)} runs, dynamic factor from {factors.min():.3f} to {factors.max():.3f}")
    for name, first, total in zip(PROBLEM["names"], found["S1"], found["ST"], strict=True):
        print(f"{name:8} first order {first:.2f}, total {total:.2f}")


if __name__ == "__main__":
    main()
