"""Values of random pairs of gears: finite and of the right sign, or absent with a true reason.

    EVOLVENT_LIBRARY=libevolvent.so.0 python tests/library/strength_judge.py --seeds 20000
    EVOLVENT_LIBRARY=libevolvent.so.0 python tests/library/strength_judge.py --seeds 200 --elements
    EVOLVENT_LIBRARY=libevolvent.so.0 python tests/library/strength_judge.py --seed 17  # its case

A reason is true if the other values of the sheet, or the case, agree with it.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

sys.path[:0] = [str(Path(__file__).resolve().parents[1])]

import evolvent  # noqa: E402
from evolvent.errors import AnalysisError  # noqa: E402
from library.strength_pairs import Case, strength_pair  # noqa: E402

POSITIONS = 24
WITH_ERRORS = 50  # one seed of these has its pitch errors in the static analysis: many positions
CLOSE = 1e-9  # relative difference of two ways to the same number
LEAST_WIDTH = 4e-3  # for which ISO 1328-1 has helix tolerances [m]
Rows = dict[str, dict[str, Any]]

# Rows of a data sheet whose values can be 0 or negative.
SIGNED = {
    *("profile_shift", "generating_shift", "undercut_shift", "thickness_allowance"),
    *("tip_alteration", "tip_clearance", "tip_clearance_modules", "approach", "recess"),
    *("backlash", "circumferential_backlash", "radial_backlash"),
    *(f"sliding_{point}" for point in "abcde"),
}
NEGATIVE = {"root_compression"}
NOT_NEGATIVE = {"bore", "speed", "rack_root_radius", *(f"curvature_{point}" for point in "abcde")}
AT_LEAST = {"dynamic_factor": 0.75, "dynamic_factor_of_class": 0.75}  # C_v7, equation DS16


@dataclass
class Judged:
    """Verdict on a seed."""

    seed: int
    refusal: str = ""  # the line, if the case is rejected
    values: int = 0  # finite ones
    absent: Counter[str] = field(default_factory=Counter)  # values by their reason
    wrong: list[str] = field(default_factory=list)

    def check(self, is_right: bool | np.bool_, text: str) -> None:
        """Note a defect."""
        if not is_right:
            self.wrong.append(text)


def judge(seed: int, finite_elements: bool = False) -> Judged:
    """Judge data sheet, summary and static analysis of a seed's case."""
    case, judged = strength_pair(seed, finite_elements), Judged(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            sheet = evolvent.datasheet(case)["rows"]
        except AnalysisError as refusal:
            judged.refusal = str(refusal)
            judged.check("\n" not in judged.refusal, "refused in several lines")
            judged.check(refusal.code == 3, f"refused with code {refusal.code}")
            return judged
        judge_sheet(judged, case, {row["key"]: row for row in sheet})
        judge_summary(judged, evolvent.show(case))
        if seed % WITH_ERRORS:
            for wheel in case["wheels"]:
                wheel.pop("accuracy", None)
        try:
            static = evolvent.static(case, points=POSITIONS)
        except AnalysisError as refusal:
            judged.refusal = f"static: {refusal}"
            judged.check("\n" not in judged.refusal, "static refused in several lines")
        else:
            judge_static(judged, case, static)
    return judged


# The data sheet.


def judge_sheet(judged: Judged, case: Case, rows: Rows) -> None:
    """Check the rows of a data sheet."""
    for key, row in rows.items():
        for value in row["values"]:
            if value is None:
                judged.absent[row["note"]] += 1
                judged.check(row["note"], f"{key}: absent without a reason")
                continue
            judged.values += 1
            judged.check(has_right_sign(key, value), f"{key}: {value}")
        if None in row["values"] and row["note"]:
            why = is_true(row["note"], key, rows, case)
            judged.check(why is not None, f"{key}: unknown reason: {row['note']}")
            judged.check(why is not False, f"{key}: a reason that is not true: {row['note']}")
    judge_relations(judged, case, rows)


def has_right_sign(key: str, value: float) -> bool:
    """Whether a value of a data sheet is finite and has the sign of its quantity."""
    if not math.isfinite(value):
        return False
    if key in SIGNED:
        return True
    if key in NEGATIVE:
        return value < 0
    if key in NOT_NEGATIVE:
        return value >= 0
    return value >= AT_LEAST[key] if key in AT_LEAST else value > 0


def number(rows: Rows, key: str, column: int = 0) -> float:
    """A value of a row; NaN if it is absent."""
    value = rows[key]["values"][column]
    return math.nan if value is None else float(value)


def is_true(note: str, key: str, rows: Rows, case: Case) -> bool | None:
    """Whether a reason agrees with the other values; None for a reason that is not listed."""
    ratio = number(rows, "contact_ratio")
    loaded = any(wheel.get("loads") for wheel in case["wheels"])
    point = key[-1] if key[-2:-1] == "_" else ""
    on_base = point and 0.0 in rows[f"curvature_{point}"]["values"]
    classes = [wheel.get("accuracy", {}).get("class", 0) for wheel in case["wheels"]]
    truths: dict[str, bool] = {
        "no nominal load of this mesh": not loaded,
        "no nominal speed": loaded and number(rows, "speed") == 0,
        "contact ratio below 1": ratio < 1,
        "contact ratio not above 1": ratio <= 1,
        "contact ratio of 2 or more": ratio >= 2,
        "the pitch point is not on the path": min(number(rows, "approach"), number(rows, "recess"))
        < 0,
        "the path ends on a base circle": bool(on_base),
        "for contact ratios from 1 to 2 with the pitch point": not 1 <= ratio <= 2
        or min(number(rows, "approach"), number(rows, "recess")) < 0,
        "the gears have no compliance": not any("compliance" in w for w in case["wheels"]),
        "a gear without finite elements": not all("compliance" in w for w in case["wheels"]),
        "the tip reliefs of the two gears differ": 0 < max(classes) <= 5,
        "no tolerance class, or outside the limits": is_absent(rows[key])
        == [
            not classed or ("helix" in key and width < LEAST_WIDTH)
            for classed, width in zip(
                in_order(classes, case), rows["face_width"]["values"], strict=True
            )
        ],
        "q_s outside 1 to 8, or no tangent": True,
        "method B for gears of steel": not all(is_steel(case, wheel) for wheel in case["wheels"]),
        "no formula for an undercut gear": any(
            undercut > generating
            for undercut, generating in zip(
                rows["undercut_shift"]["values"], rows["generating_shift"]["values"], strict=True
            )
        ),
        "the path of contact is too short for two pairs": min(
            number(rows, "approach"), number(rows, "recess")
        )
        < number(rows, "base_pitch") / 2,
        "give span_teeth": key == "base_tangent_length",
        "give ball_diameter": key == "dimension_over_balls",
    }
    found = [true for reason, true in truths.items() if reason in note]
    return all(found) if found else None


def is_steel(case: Case, wheel: dict[str, Any]) -> bool:
    """Whether the material of a wheel has the stiffness and density of steel."""
    material = case["materials"][wheel["material"]]
    stiffness = material["youngs_modulus"] / (1 - material["poisson_ratio"] ** 2)
    return bool(200e9 <= stiffness <= 250e9 and 7400 <= material["density"] <= 8200)


def in_order(values: list[int], case: Case) -> list[int]:
    """Values of the wheels of a case for the driving and the driven wheel."""
    return values if case["meshes"][0]["driving"] == case["wheels"][0]["name"] else values[::-1]


def is_absent(row: dict[str, Any]) -> list[bool]:
    """For each value of a row whether it is absent."""
    return [value is None for value in row["values"]]


def judge_relations(judged: Judged, case: Case, rows: Rows) -> None:
    """Check relations between the rows."""
    for point in "abcde":
        one, other = (number(rows, f"sliding_{point}", i) for i in (0, 1))
        if math.isfinite(one + other):
            size = (1 + abs(one)) * (1 + abs(other))
            judged.check(
                abs((1 - one) * (1 - other) - 1) <= CLOSE * size,
                f"sliding at {point} {one} {other}",
            )
    force, width = number(rows, "normal_force"), number(rows, "common_width")
    if not math.isfinite(force):
        return
    close = {
        "line_load": force / width,
        "torque": force * number(rows, "base_diameter") / 2,
        "normal_force": nominal_force(case, rows),
    }
    for key, expected in close.items():
        judged.check(
            math.isclose(number(rows, key), expected, rel_tol=CLOSE),
            f"{key} {number(rows, key)} against {expected}",
        )
    for side in (0, 1):
        factors = [number(rows, key, side) for key in ("form_factor", "stress_correction_factor")]
        stress = number(rows, "nominal_stress", side)
        angle, module = number(rows, "pressure_angle"), number(rows, "normal_module")
        expected = force / width / module * math.prod(factors) * math.cos(angle)
        judged.check(
            math.isnan(expected) == math.isnan(stress)
            and not abs(stress - expected) > CLOSE * expected,
            f"nominal_stress {stress} against {expected}",
        )


def nominal_force(case: Case, rows: Rows) -> float:
    """Normal force by the torque of the driving gear [N]."""
    driving = next(w for w in case["wheels"] if w["name"] == case["meshes"][0]["driving"])
    load = driving["loads"][0]
    torque = load["value"] if load["kind"] == "torque" else load["torque"]
    return abs(float(torque)) / (number(rows, "base_diameter") / 2)


# The summary of `evolvent show`.


def leaves(tree: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Values of a JSON object by their paths."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from leaves(value, f"{path}/{key}")
    elif isinstance(tree, list):
        for i, value in enumerate(tree):
            yield from leaves(value, f"{path}/{i}")
    else:
        yield path, tree


def judge_summary(judged: Judged, shown: dict[str, Any]) -> None:
    """Check that the numbers of `evolvent show` are finite, and stresses positive."""
    for path, value in leaves({key: shown[key] for key in shown if key != "case"}):
        if isinstance(value, float):
            judged.check(math.isfinite(value), f"show{path}: {value}")
            if "stress" in path and "compression" not in path:
                judged.check(value > 0, f"show{path}: {value}")


# The static analysis.

STEEP = "slopes of relieved flanks move the contact off the line of action"  # a warning
ROOTS = ("root_stress_max", "root_stress_min")


def judge_static(judged: Judged, case: Case, static: xr.Dataset) -> None:
    """Check forces, pressures, stresses and losses of a static analysis."""
    loaded = static["pair_normal_force"] > 0
    kind = static["pair_contact_kind"]
    sharp = loaded & (kind >= 2)
    has_elements = all("compliance" in wheel for wheel in case["wheels"])
    for name, variable in static.variables.items():
        values = np.asarray(variable.values)
        if values.dtype.kind == "f":
            judged.check(not np.isinf(values).any(), f"static {name}: infinite")
            judged.values += int(np.isfinite(values).sum())
    pressure = static["pair_contact_pressure"]
    is_steep = STEEP in static.attrs["warnings"]
    judged.check(
        is_steep or bool((pressure.notnull() | sharp).all()),
        "static: a flank contact without a pressure",
    )
    judged.check(bool((pressure.fillna(1) >= 0).all()), "static: a negative pressure")
    judged.check(
        bool((pressure.fillna(1).where(loaded, 1) > 0).all()), "static: loaded, pressure 0"
    )
    for name in ("pair_normal_force", "force_share", "elastic_energy", "largest_edge_force"):
        judged.check(bool((static[name] >= 0).all()), f"static {name}: negative or NaN")
    for name in (
        *("mean_tangent_stiffness", "mean_secant_stiffness", "loaded_contact_ratio"),
        *("loaded_tooth_loss_factor", "largest_contact_pressure", "largest_force_share"),
        *("tangent_stiffness", "loaded_secant_stiffness", "smallest_tangent_stiffness"),
        *("pair_stiffness_per_width", "mesh_stiffness_per_width", "line_load"),
    ):
        values = static[name].values
        judged.check(bool((values > 0).all()), f"static {name}: {np.nanmin(values)} or NaN")
    for name in (
        "transmission_error",
        "mean_transmission_error",
        "peak_to_peak_transmission_error",
    ):
        judged.check(bool(static[name].notnull().all()), f"static {name}: NaN")
    if not is_steep:
        judge_points(judged, static)
        judge_balance(judged, static)
    for name in ROOTS:
        judged.check((name in static) == has_elements, f"static {name}: there or not")
        if name in static:
            right = static[name] > 0 if name.endswith("max") else static[name] < 0
            judged.check(bool(right.all()), f"static {name}: of the wrong sign or NaN")


def judge_points(judged: Judged, static: xr.Dataset) -> None:
    """Check the pressures at A to E: where the nominal one exists, the other one does too."""
    for point in "abcde":
        nominal = static[f"nominal_pressure_at_{point}"].values
        found = static[f"contact_pressure_at_{point}"].values
        judged.check(
            bool((np.isnan(nominal) | (nominal > 0)).all()), f"static nominal pressure at {point}"
        )
        judged.check(
            bool((found[np.isfinite(nominal)] >= 0).all()), f"static pressure at {point}: NaN"
        )


def judge_balance(judged: Judged, static: xr.Dataset) -> None:
    """Check that the forces of all pairs carry the torque, within the slopes of the flanks."""
    ratio = static["pair_normal_force"].sum("pair") / static["tooth_force"]
    judged.check(bool((abs(ratio - 1) < 0.2).all()), f"static: forces carry {ratio.values.max()}")


# The command.


def by_default(seed: int) -> Judged:
    """Judge a pair without finite elements."""
    return judge(seed)


def with_elements(seed: int) -> Judged:
    """Judge a pair with finite elements."""
    return judge(seed, finite_elements=True)


def main() -> None:
    """Judge seeds, and report counts, defects and refusals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--seeds", type=int, default=0, help="up to, without this one")
    parser.add_argument("--seed", type=int, help="this one, with its case on stdout")
    parser.add_argument("--elements", action="store_true", help="compliant by finite elements")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    work = with_elements if given.elements else by_default
    if given.seed is not None:
        print(json.dumps(strength_pair(given.seed, given.elements)))
        print(work(given.seed), file=sys.stderr)
        return
    with ProcessPoolExecutor(given.jobs) as pool:
        report(list(pool.map(work, range(given.first, given.seeds), chunksize=8)))


def report(judged: list[Judged]) -> None:
    """Print counts, defects and refusals."""
    absent: Counter[str] = sum((j.absent for j in judged), Counter())
    refusals = Counter(generic(j.refusal) for j in judged if j.refusal)
    refused = sum(1 for j in judged if j.refusal and not j.values)
    print(f"{len(judged)} cases, {refused} refused, {sum(j.values for j in judged)} values finite")
    print(f"{sum(absent.values())} values absent:")
    for reason, count in absent.most_common():
        print(f"{count:8d} {reason}")
    for reason, count in refusals.most_common():
        print(f"{count:8d} {reason}")
    for one in judged:
        for text in one.wrong:
            print(f"seed {one.seed}: {text}")


def generic(refusal: str) -> str:
    """A refusal without its numbers and names."""
    text = "".join("#" if c.isdigit() else c for c in refusal)
    while "##" in text:
        text = text.replace("##", "#")
    return text[:110]


if __name__ == "__main__":
    main()
