"""Sensitivity indices: shares of the variance of a result due to parameters.

Saltelli's samples give first-order and total Sobol indices (Saltelli et al. 2010, Comput. Phys.
Commun. 181, 259-270); samples of a Sobol sequence or a Latin hypercube give first-order indices by
random balance designs (Tarantola, Gatelli and Mara 2006, Reliab. Eng. Syst. Saf. 91, 717-727).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from evolvent.errors import USAGE, SweepError, needing
from evolvent.sweep.journal import DONE

FEWEST = 32  # samples; with fewer the indices are noise


def sobol_indices(summary: xr.Dataset, response: str) -> xr.Dataset:
    """Compute sensitivity indices of a result.

    Cases that failed or are missing are omitted; for Saltelli's samples the whole group of such a
    case is omitted.

    Parameters
    ----------
    summary : as from `open_summary`, of a plan by saltelli, sobol or latin_hypercube.

    Returns
    -------
    Dataset with the dimension parameter: `first_order`, and `total` for Saltelli's samples, each
    with the half-width of its 95 % confidence interval. The attribute `left_out` counts cases.

    Raises
    ------
    SweepError
        No such plan or result, too few cases, or SALib is not installed.
    """
    sampling = json.loads(str(summary.attrs.get("sampling", "{}")))
    method = summary.attrs.get("method")
    if not sampling:
        raise SweepError(
            f"sensitivity indices need a plan by saltelli, sobol or latin_hypercube, not {method}",
            USAGE,
        )
    if response not in summary or summary[response].attrs.get("role") != "result":
        raise SweepError(f"the summary has no result '{response}'", USAGE)
    with needing("sensitivity", "Sobol indices need SALib"):
        import SALib  # noqa: F401
    values = summary[response].values.astype(float)
    good = (summary["status"].values == DONE) & np.isfinite(values)
    names, group = sampling["names"], 1
    if method == "saltelli":
        group = 2 * len(names) + 2 if sampling["second_order"] else len(names) + 2
        good = np.repeat(good.reshape(-1, group).all(axis=1), group)
    count = int(good.sum()) // group
    if count < FEWEST:
        what = "complete groups" if method == "saltelli" else "cases"
        raise SweepError(f"{count} {what} are too few for sensitivity indices; take {FEWEST}")
    if np.ptp(values[good]) == 0.0:
        raise SweepError("the result is the same in all cases; there is no variance to share")
    with np.errstate(all="ignore"):
        found = _analysed(summary.isel(case=good), sampling, values[good])
    indices = {
        f"{kind}{word}": ("parameter", np.asarray(found[f"{key}{end}"], dtype=float))
        for kind, key in (("first_order", "S1"), ("total", "ST"))
        for word, end in (("", ""), ("_confidence", "_conf"))
        if key in found
    }
    return xr.Dataset(
        indices,
        coords={"parameter": names},
        attrs={"response": response, "method": method, "left_out": int((~good).sum())},
    )


def _analysed(
    summary: xr.Dataset, sampling: dict[str, Any], values: np.ndarray
) -> Mapping[str, Any]:
    """Analyse the valid cases with SALib."""
    from SALib.analyze import rbd_fast, sobol

    names, seed = sampling["names"], int(summary.attrs["seed"])
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    if summary.attrs["method"] == "saltelli":
        second = bool(sampling["second_order"])
        return dict(sobol.analyze(problem, values, calc_second_order=second, seed=seed))
    # Only the order of a parameter's values matters; texts are replaced by their rank.
    ranks = [np.unique(summary[name].values, return_inverse=True)[1] for name in names]
    samples = np.stack(ranks, axis=1).astype(float)
    return dict(rbd_fast.analyze(problem, samples, values, seed=seed))
