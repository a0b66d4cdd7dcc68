"""Friction laws of an operating point in whole cases: the coefficient, its lubricant, refusals."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from system.real_cases import real_pair

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

TEETH, MODULE, WIDTH = (19, 34), 3e-3, 0.024
TORQUE, SPEED = 120.0, 150.0
OIL = {"viscosity": "20 mPa s", "roughness": "0.5 um"}


def case(law: str, sign: int = -1, *, swapped: bool = False, **mesh: Any) -> dict[str, Any]:
    """A pair at a prescribed speed under a torque."""
    loads = [
        {"loads": [{"kind": "speed", "value": sign * SPEED}]},
        {"loads": [{"kind": "torque", "value": sign * TORQUE}]},
    ]
    one = real_pair(
        TEETH,
        wheels=tuple(loads),
        mesh={
            "backlash": 1e-4,
            "damping": {"law": "ratio", "value": 0.1},
            "friction": {"law": law, "regularisation_velocity": 1e-3},
            "driving_rotation": "clockwise" if sign < 0 else "counterclockwise",
            **mesh,
        },
        duration=1e-3,
        output_interval=1e-5,
        initial={"kind": "steady"},
    )
    one["lubricant"] = dict(OIL)
    if swapped:
        one["wheels"] = one["wheels"][::-1]
    return one


@pytest.fixture
def shown(evolvent: Evolvent, tmp_path: Path) -> Callable[..., dict[str, Any]]:
    def of(one: dict[str, Any], *words: str) -> dict[str, Any]:
        file = tmp_path / "case.yaml"
        file.write_text(json.dumps(one))
        result = evolvent("show", file, "--json", *words)
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    return of


def of_mesh(document: dict[str, Any], key: str) -> Any:
    """Value of a derived quantity of the mesh, wherever `show` lists it."""
    if isinstance(document, dict):
        if key in document:
            value = document[key]
            return value["value"] if isinstance(value, dict) else value
        parts = list(document.values())
    else:
        parts = document if isinstance(document, list) else []
    for part in parts:
        found = of_mesh(part, key) if isinstance(part, (dict, list)) else None
        if found is not None:
            return found
    return None


def expected(law: str, document: dict[str, Any], eta: float = 20, ra: float = 0.5) -> float:
    alpha, force = of_mesh(document, "working_pressure_angle"), of_mesh(document, "nominal_force")
    base = [MODULE * z / 2 * math.cos(math.radians(20)) for z in TEETH]
    rolling = 2 * SPEED * base[0] * math.tan(alpha)
    radius = 1 / sum(1 / (r * math.tan(alpha)) for r in base)
    load = max(abs(force) / of_mesh(document, "common_width") / 1e3, 150.0)
    mu = (load / (rolling * radius * 1e3)) ** 0.2 * eta**-0.05
    if law == "schlenk":
        return 0.048 * mu * ra**0.25
    return 0.045 * mu * 3.8 * (ra / (MODULE * TEETH[0] * 1e3)) ** 0.25


LAWS = pytest.mark.parametrize("law", ["schlenk", "mean_roughness"])


@LAWS
@pytest.mark.parametrize("swapped", [False, True], ids=["pinion first", "gear first"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_coefficient_is_that_of_the_nominal_operating_point(
    shown, law: str, sign: int, swapped: bool
) -> None:
    document = shown(case(law, sign, swapped=swapped))
    alpha = of_mesh(document, "working_pressure_angle")
    # `show` prints angles in degrees
    assert alpha is not None
    mu = of_mesh(document, "friction_coefficient")
    assert mu == pytest.approx(expected(law, document), rel=1e-6)


@LAWS
def test_a_mesh_may_replace_a_key_of_the_lubricant(shown, law: str) -> None:
    document = shown(case(law, lubricant={"roughness": "2 um"}))
    assert of_mesh(document, "friction_coefficient") == pytest.approx(
        expected(law, document, ra=2.0), rel=1e-6
    )


@LAWS
def test_a_run_has_the_bits_of_one_with_the_coefficient_given(runs, shown, law: str) -> None:
    one = case(law)
    run = runs(one)
    assert run.exit_code == 0, run.messages
    h = run.history
    f_n, f_t, v = (h[key].values for key in ("normal_force", "friction_force", "sliding_velocity"))
    slides = np.abs(v) > 1e-3
    factor = np.abs(h["pair_friction_force"] / h["pair_normal_force"]).values
    factor = factor[np.isfinite(factor)]
    mu = float(factor.max())
    assert mu == pytest.approx(of_mesh(shown(one), "friction_coefficient"), rel=1e-6)
    assert slides.any()
    assert np.abs(f_t).max() <= mu * f_n.max() * (1 + 1e-14)
    one["meshes"][0]["friction"] = {
        "law": "coulomb",
        "coefficient": mu,
        "regularisation_velocity": 1e-3,
    }
    given = runs(one).history
    for name in ("normal_force", "friction_loss", "angular_velocity"):
        np.testing.assert_allclose(
            given[name], h[name], rtol=1e-9, atol=1e-9 * float(h[name].max())
        )


@LAWS
@pytest.mark.parametrize("key", OIL)
def test_a_missing_lubricant_is_refused_with_its_key(
    evolvent: Evolvent, tmp_path: Path, law: str, key: str
) -> None:
    one = case(law)
    del one["lubricant"][key]
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    result = evolvent("show", file)
    assert result.returncode == 3
    assert len(result.stderr.splitlines()) == 1
    assert f"needs '{key}' of the lubricant" in result.stderr
    assert "lubricant: {viscosity: 20 mPa s, roughness: 0.5 um}" in result.stderr


@LAWS
def test_loads_that_balance_at_rest_have_no_coefficient(
    evolvent: Evolvent, tmp_path: Path, law: str
) -> None:
    one = case(law)
    ratio = TEETH[1] / TEETH[0]
    for wheel, torque in zip(one["wheels"], (-10.0, -10.0 * ratio), strict=True):
        wheel["loads"] = [{"kind": "torque", "value": torque}]
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    result = evolvent("show", file)
    assert result.returncode == 3
    assert "the wheels are at rest" in result.stderr
