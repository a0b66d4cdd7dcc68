"""The command evolvent-post fatigue."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import option
from evolvent.commands.post.common import AsJson, File, complain, open_with_warning
from evolvent.commands.post.signal_options import Times
from evolvent.commands.program import json_number, new_console, right, say
from evolvent.errors import replacing
from evolvent.units import quantity

if TYPE_CHECKING:
    from evolvent.physics.load_spectrum import PointSpectrum, WheelSpectrum

CLASSES = 12  # of ranges in the table


def fatigue(
    file: File,
    wheels: Annotated[
        list[str] | None,
        option("--wheel NAME", "Wheel; may be repeated; if not given, all wheels with teeth."),
    ] = None,
    turns: Annotated[
        int, option("--turns N", "Count the last N revolutions of each wheel.", min=1)
    ] = 1,
    whole_window: Annotated[
        bool,
        option(
            "--whole-window",
            "Count the whole window, whatever its revolutions; the residue gives half cycles.",
        ),
    ] = False,
    *,
    times: Times,
    output: Annotated[
        Path | None, option("-o --output FILE", "Figure (.png, .svg, .pdf) of the spectra.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Count load cycles of teeth: root stress, tooth force, damage, safety factors.

    \b
    The history needs the outputs of the tooth pairs, the root stress wheels with finite elements,
    damage and safety factors the key `strength` of their materials.
    Example:
      evolvent-post fatigue compliant-pair.h5 --wheel pinion -o pinion.png
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.physics.load_spectrum import load_spectra

    with open_with_warning(file) as history:
        spectra = load_spectra(
            history,
            wheels,
            turns=turns,
            whole_window=whole_window,
            begin=times.begin,
            end=times.end,
        )
    if output is not None:
        from evolvent.figures.load_spectrum import draw_load_spectra
        from evolvent.figures.style import save

        with replacing(output) as path:
            save(draw_load_spectra(spectra), path)
    if as_json:
        say(json.dumps([_as_json(spectrum) for spectrum in spectra], indent=2))
        return
    for spectrum in spectra:
        _print(spectrum)
    if output is not None:
        say(str(output))
    for spectrum in spectra:
        if not spectrum.is_resolved:
            complain(f"{file}: wheel {spectrum.wheel}: {spectrum.change_text}")


def _print(spectrum: WheelSpectrum) -> None:
    """Print the results of a wheel, and classes of cycles of its most loaded tooth."""
    from rich.table import Table

    console = new_console()

    def line(text: str) -> None:
        console.print(text, highlight=False, markup=False)

    window = spectrum.window
    of = "repeating" if window.repeats else "half cycles for the residue"
    line(
        f"{spectrum.wheel}: {window.turns:.6g} revolutions, t = {window.begin:.6g} to "
        f"{window.end:.6g} s, {of}"
    )
    for label, text in results(spectrum):
        line(f"  {label}: {text}")
    for remark in spectrum.remarks:
        if remark != spectrum.change_text:  # on stderr
            line(f"  {remark}")
    for what, point, units in (
        ("root stress", spectrum.worst_root, "Pa"),
        ("tooth force", spectrum.worst_force, "N"),
    ):
        if point is None or point.cycles.ranges.size == 0:
            continue
        table = Table(right(f"range of {what} up to"), right("cycles"), box=None)
        for upper, count in classes(point):
            if count > 0.0:
                table.add_row(quantity(upper, units, 4), f"{count:g}")
        console.print(table)


def results(spectrum: WheelSpectrum) -> list[tuple[str, str]]:
    """Label and text of each result of a wheel."""
    rows = []
    root, force = spectrum.worst_root, spectrum.worst_force
    if root is not None:
        rows.append(("root stress", _point(root, "Pa")))
        rows.append(("largest root stress", quantity(spectrum.root_stress, "Pa", 5)))
    if force is not None:
        rows.append(("tooth force", _point(force, "N")))
    if root is not None and not math.isnan(root.damage):
        life = spectrum.life
        text = f"Miner sum {root.damage:.4g} in {spectrum.window.turns:.4g} revolutions"
        if not math.isnan(life):
            text += f", sum 1 after {life:.4g} revolutions" if life < math.inf else ", no limit"
        rows.append(("damage", text))
    for symbol, value, permissible, found in (
        ("S_F", spectrum.safety_f, spectrum.sigma_fp, spectrum.root_stress),
        ("S_H", spectrum.safety_h, spectrum.sigma_hp, spectrum.pressure),
    ):
        if not math.isnan(value):
            index = symbol[-1]
            rows.append(
                (
                    symbol,
                    f"{value:.4g} = sigma_{index}P/sigma_{index} = "
                    f"{quantity(permissible, 'Pa', 5)} / {quantity(found, 'Pa', 5)}",
                )
            )
    return rows


def _point(point: PointSpectrum, units: str) -> str:
    """Describe the position and the extremes of a point."""
    low, high = (quantity(value, units, 5) for value in (point.least, point.largest))
    where = f"tooth {point.tooth}, {point.side} flank"
    if not math.isnan(point.arc):
        arc = quantity(point.arc, "m", 4)
        where = f"tooth {point.tooth}, {point.side} fillet, {arc} from the form circle"
    count = float(point.cycles.counts.sum())
    return f"{low} to {high} at {where}; {count:g} cycles"


def classes(point: PointSpectrum, n: int = CLASSES) -> list[tuple[float, float]]:
    """Upper limit and number of cycles of equal classes of the range, from the largest one."""
    import numpy as np

    limits = point.cycles.largest * np.arange(1, n + 1) / n
    index = np.clip(np.searchsorted(limits, point.cycles.ranges * (1 - 1e-12)), 0, n - 1)
    counts = np.bincount(index, point.cycles.counts, n)
    return [(float(a), float(b)) for a, b in zip(limits, counts, strict=True)][::-1]


def _as_json(spectrum: WheelSpectrum) -> dict[str, Any]:
    window = spectrum.window
    return {
        "wheel": spectrum.wheel,
        "material": spectrum.material,
        "begin": window.begin,
        "end": window.end,
        "revolutions": window.turns,
        "repeating": window.repeats,
        "root_stress": [_point_json(point) for point in spectrum.root],
        "tooth_force": [_point_json(point) for point in spectrum.force],
        "root_stress_max": json_number(spectrum.root_stress),
        "contact_pressure_max": json_number(spectrum.pressure),
        "life_in_revolutions": json_number(spectrum.life),
        "S_F": json_number(spectrum.safety_f),
        "S_H": json_number(spectrum.safety_h),
        "change_without_every_second_output": json_number(spectrum.change),
        "remarks": spectrum.remarks,
    }


def _point_json(point: PointSpectrum) -> dict[str, Any]:
    cycles = point.cycles
    return {
        "tooth": point.tooth,
        "side": point.side,
        "arc": json_number(point.arc),
        "largest": point.largest,
        "least": point.least,
        "damage": json_number(point.damage),
        "cycles": [
            {"range": float(a), "mean": float(b), "count": float(c)}
            for a, b, c in zip(cycles.ranges, cycles.means, cycles.counts, strict=True)
        ],
    }
