"""The paper's contact did not change (a recorded value, a weak test)."""

from __future__ import annotations

import numpy as np

from kernel.kernel import Kernel
from kernel.recorded_states import COLUMNS, RECORD, evaluations


def test_the_papers_contact_is_that_of_the_record_at_1000_states(kernel: Kernel) -> None:
    """To 1e-14 of each column's maximum: another order of additions may change the last bits."""
    recorded = np.loadtxt(RECORD, delimiter=",", skiprows=1)
    now = np.array(list(evaluations(kernel)))
    assert recorded.shape == now.shape == (1000, len(COLUMNS))
    assert (np.abs(now - recorded) <= 1e-14 * np.abs(recorded).max(axis=0)).all()
