"""The command evolvent-post compare."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import argument, option
from evolvent.commands.post.common import BROKEN, AsJson, complain, open_with_warning
from evolvent.commands.program import json_number, new_console, right, say
from evolvent.units import displayed

if TYPE_CHECKING:
    import xarray as xr


def compare(
    first: Annotated[Path, argument("A", "History (.h5).")],
    second: Annotated[Path, argument("B", "History (.h5) of a run with the same variables.")],
    tolerance: Annotated[
        float | None, option("--tolerance X", "Largest accepted relative difference.", min=0.0)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show the largest difference between two runs for every variable.

    \b
    Relative differences refer to the largest absolute value of the variable in both runs.
    The exit code is 1 if a difference exceeds the tolerance.
    Example:
      evolvent-post compare closed_form.h5 differential.h5 --tolerance 1e-6
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.physics.compare import compare_histories

    with open_with_warning(first) as one, open_with_warning(second) as two:
        result = compare_histories(one, two)
    relative = result["relative"].values
    beyond = relative > tolerance if tolerance is not None else relative < 0.0
    if as_json:
        say(json.dumps(_differences_as_json(result), indent=2))
    else:
        _print_differences(result, beyond.tolist())
    if beyond.any():
        worst = result.isel(variable=int(relative.argmax()))
        complain(
            f"{int(beyond.sum())} variables differ by more than {tolerance:g}, the largest being "
            f"{worst['variable'].item()} by {worst['relative'].item():.3g} of its largest value"
        )
        raise SystemExit(BROKEN)


def _print_differences(result: xr.Dataset, beyond: list[bool]) -> None:
    from rich.markup import escape
    from rich.table import Table

    table = Table("variable", right("largest difference"), right("relative"), "where", box=None)
    rows = result.to_dataframe().assign(beyond=beyond)
    differing = rows[rows["absolute"] != 0.0]
    same = len(rows) - len(differing)
    for row in differing.itertuples():
        table.add_row(
            escape(str(row.Index)),
            f"{row.absolute:.3e} {displayed(row.units)}".rstrip(),
            f"{row.relative:.2e}",
            escape(row.where),
            style="bold red" if row.beyond else None,
        )
    console = new_console()
    console.print(f"Compared on {result.attrs['times']}.", highlight=False)
    if table.row_count:
        console.print(table)
    console.print(f"{same} variables are the same to the bit.", highlight=False)
    for side, names in (("first", "only_in_first"), ("second", "only_in_second")):
        if result.attrs[names]:
            console.print(
                f"Only in the {side}: {result.attrs[names]}", highlight=False, markup=False
            )


def _differences_as_json(result: xr.Dataset) -> dict[str, Any]:
    variables = {
        str(row.Index): {
            **{key: json_number(getattr(row, key)) for key in ("absolute", "relative", "largest")},
            **{key: str(getattr(row, key)) for key in ("units", "where")},
        }
        for row in result.to_dataframe().itertuples()
    }
    return {**result.attrs, "variables": variables}
