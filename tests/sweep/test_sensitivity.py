"""Sensitivity indices of a function whose indices are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from sweeps import make_design, row, write_journal

import machine
from evolvent.errors import SweepError
from evolvent.sweep.collect import collect, open_summary
from evolvent.sweep.design import Design
from evolvent.sweep.sampling import columns
from evolvent.sweep.sensitivity import sobol_indices
from evolvent.sweep.spec import read_spec

machine.module("SALib")

# Ishigami and Homma 1990: sin x + 7 sin^2 y + 0.1 z^4 sin x on [-pi, pi]^3.
A, B = 7.0, 0.1
VARIANCE = A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18 + 0.5
FIRST = np.array([0.5 * (1 + B * np.pi**4 / 5) ** 2, A**2 / 8, 0.0]) / VARIANCE
INTERACTION = B**2 * np.pi**8 * (1 / 18 - 1 / 50) / VARIANCE  # of x and z
TOTAL = FIRST + np.array([INTERACTION, 0.0, INTERACTION])


def ishigami(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    return np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x)


def summary_of(tmp_path, method: str, samples: int, bad: tuple[int, ...] = ()) -> xr.Dataset:
    """Make a summary whose result `steps` is Ishigami's function."""
    ranges = "".join(f"- {{path: {n}, from: {-np.pi}, to: {np.pi}}}\n" for n in "xyz")
    (tmp_path / "sweep.yaml").write_text(
        f"format: 1\ncase: c\nmethod: {method}\nsamples: {samples}\nparameters:\n{ranges}"
    )
    parameters, n, sampling = columns(read_spec(tmp_path / "sweep.yaml"))
    design: Design = make_design(
        {p.name: p.values for p in parameters}, method=method, sampling=sampling
    )
    values = ishigami(*[p.values for p in parameters]).tolist()
    rows = [row(i, steps=values[i]) for i in range(n) if i not in bad]
    write_journal(tmp_path / "d", design, rows)
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    with open_summary(tmp_path / "s.h5") as summary:
        return summary.load()


def test_saltellis_samples_give_the_indices_of_ishigamis_function(tmp_path):
    indices = sobol_indices(summary_of(tmp_path, "saltelli", 1024), "steps")
    assert indices["parameter"].values.tolist() == ["x", "y", "z"]
    # Of a quasi-random sample of 1024 the errors are some hundredths.
    np.testing.assert_allclose(indices["first_order"], FIRST, atol=0.05)
    np.testing.assert_allclose(indices["total"], TOTAL, atol=0.05)
    assert indices.attrs["left_out"] == 0


@pytest.mark.parametrize("method", ["sobol", "latin_hypercube"])
def test_other_samples_give_the_first_order_alone(tmp_path, method):
    indices = sobol_indices(summary_of(tmp_path, method, 2048), "steps")
    # Random balance designs have a bias of about 1/M of ten harmonics beside the noise.
    np.testing.assert_allclose(indices["first_order"], FIRST, atol=0.08)
    assert "total" not in indices


def test_a_missing_case_takes_its_group_with_it(tmp_path):
    summary = summary_of(tmp_path, "saltelli", 1024, bad=(7, 11, 5000))
    indices = sobol_indices(summary, "steps")
    assert indices.attrs["left_out"] == 3 * 5  # groups of 3 + 2
    np.testing.assert_allclose(indices["total"], TOTAL, atol=0.05)


def test_a_plan_without_samples_and_what_is_no_result_are_refused(tmp_path):
    summary = summary_of(tmp_path, "latin_hypercube", 64)
    with pytest.raises(SweepError, match="need a plan by saltelli"):
        sobol_indices(summary.assign_attrs(sampling="{}", method="factorial"), "steps")
    with pytest.raises(SweepError, match="no result 'x'"):
        sobol_indices(summary, "x")


def test_too_few_cases_are_refused(tmp_path):
    summary = summary_of(tmp_path, "saltelli", 16)
    with pytest.raises(SweepError, match="16 complete groups are too few"):
        sobol_indices(summary, "steps")
