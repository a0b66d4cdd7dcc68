"""Cost and jumps of a response: `python benchmarks/response.py PROGRAM`.

The oscillator with rectangular mesh stiffness of docs/guides/response.md, in both directions, 401
speeds each, in at most 60 s of processor time.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import xarray as xr
import yaml

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from system.test_metrics import FORCE, STIFFNESS, rectangular
from system.test_respond import UNIT, speeds

LIMIT = 60.0  # s


def main(program: str) -> None:
    """Measure and print."""
    case = rectangular(1.0, 1, 1, "radau")
    del case["simulation"]["metrics"]
    with tempfile.TemporaryDirectory() as temporary:
        path, result = Path(temporary) / "case.yaml", Path(temporary) / "response.h5"
        path.write_text(yaml.safe_dump(case))
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        over = speeds(0.4, 2.4)
        command = [program, "respond", path, "--over", over, "--both", "-q", "-o", result]
        subprocess.run(command, check=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        with xr.open_dataset(result, engine="h5netcdf") as file:
            response = file.load()
    print(f"{response.period.size} values in {seconds:.3g} s of processor time")
    for i in range(response.sizes["jump"]):
        jump = response.isel(jump=i)
        ends = [-float(jump[f"jump_{end}"]) / UNIT for end in ("before", "after")]
        deviations = [
            float(jump[f"jump_deviation_{end}"][0]) / (FORCE / STIFFNESS)
            for end in ("before", "after")
        ]
        direction = str(response.direction[int(jump.jump_direction)].values)
        print(
            f"{direction}: {ends[0]:.6f} to {ends[1]:.6f}, deviation {deviations[0]:.4f} to "
            f"{deviations[1]:.4f}, period {int(jump.jump_period_before)} to "
            f"{int(jump.jump_period_after)}"
        )
    assert seconds <= LIMIT
    assert int(response["followed"].max()) <= 600


if __name__ == "__main__":
    main(*sys.argv[1:])
