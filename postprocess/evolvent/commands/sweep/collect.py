"""The command evolvent-sweep collect."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import option
from evolvent.commands.sweep import console
from evolvent.commands.sweep.common import Folder, OtherDesign


def collect(
    directory: Folder,
    output: Annotated[Path, option("-o --output SUMMARY", "Summary (.h5).")],
    copy_histories: Annotated[
        bool,
        option(
            "--copy-histories",
            "Copy the histories into the summary; otherwise the summary refers to them.",
        ),
    ] = False,
    parquet: Annotated[
        Path | None,
        option("--parquet FILE", "Also write the results as Parquet, without histories."),
    ] = None,
    other_design: OtherDesign = None,
) -> None:
    """Write all results to one file for xarray. Missing cases are reported and remain empty.

    \b
    Example:
      evolvent-sweep collect torque -o torque-summary.h5 --parquet torque.parquet
    """  # noqa: D301
    from evolvent.sweep import folder
    from evolvent.sweep.collect import collect as make_summary

    design = folder.design_of(directory, other_design)
    collected = make_summary(
        directory, design, output, copy_histories=copy_histories, parquet=parquet
    )
    console.show_collected(output, collected)
