"""The paper's case at 1,000 states, as evaluated by the kernel of November 2026.

Recorded values are a weak test: they show that a change of the kernel did not affect the paper's
contact, not that it was correct. Run as a script to update the record, and state the reason.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kernel.gearbox import State
from kernel.gearbox_cases import paper_gearbox
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.kernel import Kernel

RECORD = Path(__file__).with_name("recorded_states.csv")
OUTPUTS = ("gap", "normal_force", "friction_force", "sliding_velocity", "friction_arm_driving")
RATES = ("reference_speed", "speed_deviation_1", "displacement_rate_1")
COLUMNS = (*OUTPUTS, *RATES)
STATES = {CLOSED_FORM: 400, ALGEBRAIC: 300, DIFFERENTIAL: 300}


def evaluations(kernel: Kernel) -> Iterator[NDArray[np.float64]]:
    """Values of COLUMNS at every state."""
    random = np.random.RandomState(20111)  # its sequence is the same in all versions of numpy
    for tracking, count in STATES.items():
        gearbox = paper_gearbox(kernel, friction=0.3, tracking=tracking)
        start = gearbox.start()
        scale = gearbox.scales()[0]
        rates = [gearbox.names.index(name) for name in RATES]
        for _ in range(count):
            state: State = start.copy()
            state.y[0] = -0.3 * random.uniform()
            state.y[1:] += scale[1:] * random.normal(size=len(scale) - 1)
            # a loaded pair in the middle of each branch of friction
            state.y[gearbox.index("angle_deviation_1")] -= 2 * scale[2]
            gearbox.mode(state)[:] = [0, 1, random.randint(-1, 2)]
            outputs = gearbox.outputs(state)
            yield np.array(
                [float(outputs[name].ravel()[0]) for name in OUTPUTS]
                + [float(gearbox.derivative(state)[i]) for i in rates]
            )


def write(library: Path) -> None:
    """Write the record."""
    rows = [",".join(f"{value:.17g}" for value in row) for row in evaluations(Kernel(library))]
    RECORD.write_text("\n".join([",".join(COLUMNS), *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
