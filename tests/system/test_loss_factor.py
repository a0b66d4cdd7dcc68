"""Loss factor H_V of a mesh."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from system.real_cases import real_pair
from system.test_operating_friction import of_mesh

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


def test_the_loss_factor_of_fzg_gears_type_c(evolvent: Evolvent, tmp_path: Path) -> None:
    """0.19495824, computed from contact ratios 0.72258953 and 0.71494742."""
    diameters, shifts = (82.46e-3, 118.36e-3), (0.182, 0.171)
    case = real_pair(
        (16, 24),
        4.5e-3,
        wheels=tuple(
            {
                "tip_diameter": diameters[i],
                "profile_shift": shifts[i],
                "thickness_allowance": -1e-4,
                "loads": [{"kind": "torque", "value": -1.0}],
            }
            for i in (0, 1)
        ),
        mesh={"centre_distance": 91.5e-3},
    )
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(case))
    shown = evolvent("show", file, "--json")
    assert shown.returncode == 0, shown.stderr
    z_1, z_2, eps = 16, 24, 1.437537
    expected = math.pi * (1 / z_1 + 1 / z_2) * (1 - eps + 0.72258953**2 + 0.71494742**2)
    assert expected == pytest.approx(0.19495824, rel=1e-5)
    factor = of_mesh(json.loads(shown.stdout), "loss_factor")
    assert factor == pytest.approx(0.19495824, rel=1e-6)
