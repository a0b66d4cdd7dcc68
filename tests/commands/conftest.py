"""Cases shared by several tests of the command line."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
REFUSALS = (2, 3)


def without_output(words: tuple[str | Path, ...]) -> Iterator[str | Path]:
    """The words of a `run` that are valid for `validate`, too."""
    rest = iter(words)
    for word in rest:
        if word in ("-o", "--output"):
            next(rest)
        elif word not in ("-q", "--quiet"):
            yield word


@pytest.fixture
def evolvent(evolvent: Evolvent) -> Evolvent:
    """Run the program; `validate` must reject whatever `run` rejects, in every test."""

    def run(*words: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
        done = evolvent(*words, **options)
        refused = words[:1] == ("run",) and done.returncode in REFUSALS
        if refused and not done.stderr.startswith("evolvent: "):  # not the usage, not the output
            asked = evolvent("validate", *without_output(words[1:]), **options)
            assert (asked.returncode, asked.stdout) == (done.returncode, "")
            assert asked.stderr == done.stderr
        return done

    return run


@pytest.fixture
def reference_case() -> dict[str, Any]:
    """Create the pair 12/40 of module 2 mm with known reference values."""
    gears = (("pinion", 12, 0.3, 0.028), ("gear", 40, -0.1, 0.0832))
    return {
        "format": 1,
        "materials": {"steel": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}},
        "wheels": [
            {
                **{"name": name, "teeth": teeth, "module": 0.002, "profile_shift": shift},
                **{"tip_diameter": tip, "width": 0.02, "material": "steel"},
            }
            for name, teeth, shift, tip in gears
        ],
        "meshes": [
            {
                **{"driving": "pinion", "driven": "gear", "driving_rotation": "clockwise"},
                "centre_line_angle": 0,
            }
        ],
        "simulation": {"duration": 1, "output_interval": 0.1},
    }


@pytest.fixture
def reference(reference_case: dict[str, Any], tmp_path: Path) -> Path:
    path = tmp_path / "reference.yaml"
    path.write_text(json.dumps(reference_case, indent=1))
    return path
