"""The command evolvent-sweep: a thin layer over the library."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import evolvent
from evolvent.commands.sweep.common import DesignFile, Folder, Into, Jobs, OtherDesign, told
from evolvent.commands.sweep.slurm import retry, slurm
from evolvent.sweep import console, dask, folder
from evolvent.sweep.design import write_design
from evolvent.sweep.errors import FAILED_CASES, NOT_WRITTEN, SweepError
from evolvent.sweep.estimate import seconds_per_case
from evolvent.sweep.journal import read_records
from evolvent.sweep.program import cores, find_program, program_version
from evolvent.sweep.run import Tally, run_shards

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    help="""Parameter sweeps: many cases of one gearbox, here or on a Slurm cluster.

    \b
    Exit codes:
       0  done
       1  done, but some cases failed or were refused, or would be
       2  wrong usage of the command line
       3  bad plan, design, folder or summary
      74  output could not be written
      75  interrupted; the same command goes on
    """,
)


class ExecutorName(StrEnum):
    """Who runs the cases."""

    EMBEDDED = "embedded"
    DASK = "dask"


class Format(StrEnum):
    """Formats of a figure."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


def main() -> None:
    """Run the command line; an error is one line on stderr."""
    try:
        app(prog_name="evolvent-sweep")
    except SweepError as error:
        console.complain(str(error))
        sys.exit(error.code)


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(f"evolvent-sweep {evolvent.__version__}")
        raise typer.Exit


@app.command()
def plan(
    sweep: Annotated[Path, typer.Argument(metavar="SWEEP", help="Plan (.yaml).")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DESIGN", help="Design; SWEEP.h5 if not given."),
    ] = None,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Show the cases and how long they take; write nothing."),
    ] = False,
    keep_refused: Annotated[
        bool,
        typer.Option("--keep-refused", help="Exit code 0 also if cases would be refused."),
    ] = False,
) -> None:
    """Make a design, the table of all cases, from a plan.

    \b
    The program is asked about every case. What it would refuse is told, stays in the design and
    becomes rows with their reason; the exit code is 1 then, and 3 if it would refuse all cases.
    Example:
      evolvent-sweep plan examples/sweep-torque.yaml --dry-run
      evolvent-sweep plan examples/sweep-torque.yaml -o torque.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.sweep.plan import make_plan

    program = find_program()
    design, checked = make_plan(sweep, program)
    path = output if output is not None else Path(f"{sweep.stem}.h5")
    if dry_run:
        console.show_design(design)
        seconds, is_bound = seconds_per_case(design, program)
        console.show_estimate(design.n_cases, seconds, is_bound, cores())
    else:
        write_design(design, path)
        typer.echo(f"{path}: {design.n_cases} cases")
    if checked.refused:
        console.show_refusals(sweep, design, checked)
        raise typer.Exit(0 if keep_refused else FAILED_CASES)


@app.command()
def run(
    design_file: DesignFile,
    output: Into,
    jobs: Jobs = None,
    executor: Annotated[
        ExecutorName, typer.Option(help="Who runs the cases: this machine, or a Dask cluster.")
    ] = ExecutorName.EMBEDDED,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Dask scheduler; workers on this machine if not given."
        ),
    ] = None,
    shards: Annotated[
        int | None,
        typer.Option(
            "--shards",
            metavar="N",
            min=1,
            help="Split into N shards; 1, or as the folder is, if not given.",
        ),
    ] = None,
) -> None:
    """Run what is missing of a design, here and now.

    \b
    Interrupt it at any time; the same command goes on. With a Dask cluster all workers have to
    see the folder.
    Example:
      evolvent-sweep run torque.h5 -o torque
    """  # noqa: D301
    if scheduler is not None and executor is not ExecutorName.DASK:
        raise typer.BadParameter("only with --executor dask", param_hint="--scheduler")
    program = find_program()
    design = folder.open_for_run(design_file, output, program_version(program))
    workers = jobs or cores()
    split = shards or folder.common_split(output)
    if executor is ExecutorName.DASK:
        split = split or dask.split(design, program, workers)
    records = read_records(output, design, scalars=False)
    todo = folder.remaining_shards(records.recorded, split or 1)
    tally = Tally(output, todo, records)
    if executor is ExecutorName.DASK:
        code = dask.run(program, design_file, output, todo, workers, scheduler, tally)
    else:
        code = run_shards(program, design_file, output, todo, workers, tally)
    raise typer.Exit(told(output, code))


app.command()(slurm)


@app.command()
def collect(
    directory: Folder,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="SUMMARY", help="Summary (.h5).")
    ],
    copy_histories: Annotated[
        bool,
        typer.Option("--copy-histories", help="Copy histories; else the summary refers to them."),
    ] = False,
    parquet: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A copy as Parquet, without histories.")
    ] = None,
    other_design: OtherDesign = None,
) -> None:
    """Write one file of all results, for xarray. Missing cases are reported and stay empty.

    \b
    Example:
      evolvent-sweep collect torque -o torque-summary.h5 --parquet torque.parquet
    """  # noqa: D301
    from evolvent.sweep.collect import collect as make_summary

    design = folder.design_of(directory, other_design)
    collected = make_summary(
        directory, design, output, copy_histories=copy_histories, parquet=parquet
    )
    console.show_collected(output, collected)


@app.command()
def status(
    directory: Folder,
    as_json: Annotated[bool, typer.Option("--json", help="Write JSON, for scripts.")] = False,
    other_design: OtherDesign = None,
) -> None:
    """Show what is done, what failed and why, what is missing, and when it will be finished.

    \b
    Example:
      evolvent-sweep status torque
    """  # noqa: D301
    from evolvent.sweep.status import read_status

    found = read_status(directory, folder.design_of(directory, other_design))
    if as_json:
        typer.echo(json.dumps(console.status_as_json(found), indent=2))
    else:
        console.show_status(directory, found)


app.command()(retry)


@app.command()
def plot(
    file: Annotated[Path, typer.Argument(metavar="SUMMARY", help="Summary (.h5).")],
    response: Annotated[
        str | None,
        typer.Option("-r", "--response", metavar="NAME", help="Result to draw; the first one."),
    ] = None,
    against: Annotated[
        list[str] | None,
        typer.Option("-a", "--against", metavar="NAME", help="Parameter; give it twice for a map."),
    ] = None,
    indices: Annotated[bool, typer.Option("--indices", help="Draw Sobol indices instead.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Figure (png, svg, pdf).")
    ] = None,
) -> None:
    """Draw a result against one or two parameters. Cases that did not finish are marked.

    \b
    The figure is named after summary and result unless -o is given.
    Example:
      evolvent-sweep plot torque-summary.h5 --response penetration_max --against torque
      evolvent-sweep plot torque-summary.h5 -a torque -a friction -o map.png
    """  # noqa: D301
    from evolvent.figures.over_time import save
    from evolvent.sweep import figures
    from evolvent.sweep.collect import open_summary
    from evolvent.sweep.sensitivity import sobol_indices

    if indices and against:
        raise typer.BadParameter("has no meaning with --indices", param_hint="--against")
    with open_summary(file) as summary:
        known = figures.results(summary)
        if not known:
            raise SweepError(f"{file}: has no results; no case is recorded")
        name = response or known[0]
        if indices:
            found = sobol_indices(summary, name)
            console.show_indices(found)
            figure = figures.figure_indices(found)
        else:
            figure = figures.figure_response(summary, name, against or ())
    path = output or Path(f"{file.stem}-{name}{'-indices' if indices else ''}.png")
    if path.suffix.lstrip(".").lower() not in list(Format):
        raise typer.BadParameter(f"{path} must end in .png, .svg or .pdf", param_hint="--output")
    try:
        save(figure, path)
    except OSError as error:
        raise SweepError(f"{path}: cannot be written ({error.strerror})", NOT_WRITTEN) from error
    typer.echo(path)
