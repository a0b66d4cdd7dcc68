"""Influence functions of the root stress, from the library."""

from __future__ import annotations

from ctypes import POINTER, byref, c_double, c_int
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from evolvent.library.binding import ROOT_ARCS, Error, load
from evolvent.library.cases import Case, error_of

Values = NDArray[np.float64]
_DONE = 0


class RootInfluence:
    """Stress in the fillets of a tooth under unit line loads on a wheel of an opened case.

    Parameters
    ----------
    handle : of the case, from `opened`.
    case : for error messages.
    wheel : its index.
    """

    def __init__(self, handle: Any, case: Case, wheel: int) -> None:
        self._handle, self._case, self._wheel = handle, case, wheel
        self.arcs = np.empty(ROOT_ARCS)  # from the form circle [m]
        self.stress([], [], [])

    def stress(self, flanks: ArrayLike, rho: ArrayLike, teeth: ArrayLike) -> Values:
        """Stress of the right and the left fillet at all arcs [1/m], shape (n, 2, arcs).

        Parameters
        ----------
        flanks : 0 right, which faces counterclockwise, 1 left.
        rho : radii of curvature at the loads [m].
        teeth : indices of the loaded teeth minus that of the stressed tooth, counterclockwise.

        Raises
        ------
        AnalysisError
            The wheel has no finite elements.
        """
        integers = [np.ascontiguousarray(values, dtype=np.intc) for values in (flanks, teeth)]
        reals = np.ascontiguousarray(rho, dtype=float)
        found = np.empty((reals.size, 2, ROOT_ARCS))

        def pointer(values: Any, kind: Any) -> Any:
            return values.ctypes.data_as(POINTER(kind))

        error = Error()
        code = load().evolvent_root_influence(
            self._handle,
            self._wheel,
            reals.size,
            pointer(integers[0], c_int),
            pointer(reals, c_double),
            pointer(integers[1], c_int),
            pointer(self.arcs, c_double),
            pointer(found, c_double),
            byref(error),
        )
        if code != _DONE:
            raise error_of(error, self._case)
        return found
