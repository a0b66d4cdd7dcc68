"""Shares of the variance of a result that parameters are responsible for.

Saltelli's samples give first-order and total Sobol indices (Saltelli et al. 2010, Comput. Phys.
Commun. 181, 259-270); samples of a Sobol sequence or a Latin hypercube give first-order indices by
random balance designs (Tarantola, Gatelli and Mara 2006, Reliab. Eng. Syst. Saf. 91, 717-727).
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from evolvent.sweep.errors import USAGE, SweepError
from evolvent.sweep.journal import DONE

FEWEST = 32  # samples; with fewer the indices are noise


def sobol_indices(summary: xr.Dataset, response: str) -> xr.Dataset:
    """Sensitivity indices of a result.

    Cases that failed or are missing are left out; of Saltelli's samples, whose cases belong
    together, the whole group is.

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
        No such plan or result, too few cases, or SALib is not there.
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
    try:
        import SALib  # noqa: F401
    except ImportError as error:
        raise SweepError(
            "Sobol indices need SALib; install it with: pip install 'evolvent[sensitivity]'"
        ) from error
    values = summary[response].values.astype(float)
    good = (summary["status"].values == DONE) & np.isfinite(values)
    by = _saltelli if method == "saltelli" else _random_balance
    with np.errstate(all="ignore"):
        found, left_out = by(summary, sampling, values, good)
    indices = xr.Dataset(
        {name: ("parameter", np.asarray(v, dtype=float)) for name, v in found.items()},
        coords={"parameter": sampling["names"]},
    )
    return indices.assign_attrs(response=response, method=method, left_out=left_out)


def _saltelli(
    summary: xr.Dataset, sampling: dict[str, Any], values: np.ndarray, good: np.ndarray
) -> tuple[dict[str, Any], int]:
    from SALib.analyze import sobol

    names = sampling["names"]
    second = bool(sampling["second_order"])
    group = 2 * len(names) + 2 if second else len(names) + 2
    whole = good.reshape(-1, group).all(axis=1)
    _check_enough(int(whole.sum()), "complete groups")
    kept = values.reshape(-1, group)[whole].reshape(-1)
    _check_varies(kept, summary)
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    seed = int(summary.attrs["seed"])
    found = sobol.analyze(problem, kept, calc_second_order=second, seed=seed)
    return {
        "first_order": found["S1"],
        "first_order_confidence": found["S1_conf"],
        "total": found["ST"],
        "total_confidence": found["ST_conf"],
    }, int(values.size - kept.size)


def _random_balance(
    summary: xr.Dataset, sampling: dict[str, Any], values: np.ndarray, good: np.ndarray
) -> tuple[dict[str, Any], int]:
    from SALib.analyze import rbd_fast

    names = sampling["names"]
    _check_enough(int(good.sum()), "cases")
    _check_varies(values[good], summary)
    # Only the order of a parameter's values matters: texts count by their rank.
    ranks = np.stack(
        [np.unique(summary[n].values[good], return_inverse=True)[1] for n in names], axis=1
    )
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    seed = int(summary.attrs["seed"])
    found = rbd_fast.analyze(problem, ranks.astype(float), values[good], seed=seed)
    return {
        "first_order": found["S1"],
        "first_order_confidence": found["S1_conf"],
    }, int((~good).sum())


def _check_enough(count: int, what: str) -> None:
    if count < FEWEST:
        raise SweepError(f"{count} {what} are too few for sensitivity indices; take {FEWEST}")


def _check_varies(values: np.ndarray, summary: xr.Dataset) -> None:
    if np.ptp(values) == 0.0:
        raise SweepError("the result is the same in all cases; there is no variance to share")
