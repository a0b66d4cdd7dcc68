"""Cases that several tests of the command line use."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def reference_case() -> dict[str, Any]:
    """Make the pair 12/40 of module 2 mm, whose values the program was given to meet."""
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
