"""The work-precision plot: error over processor time, one panel for each friction."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# A shade and a marker for each program, a line style for each of its methods.
LOOKS: dict[str, tuple[str, str]] = {
    "evolvent": ("#000000", "o"),
    "heyoka": ("#0057b7", "s"),
    "numbalsoda": ("#c44e00", "^"),
    "rumoca": ("#8a5fbf", "D"),
    "scipy": ("#3a9a5b", "v"),
    "scikit-sundae": ("#999999", "P"),
}
LINES = ("-", "--", ":")


def draw(runs: Sequence[Any], labels: Sequence[str], path: Path) -> None:
    """Draw runs with label, friction, error and seconds; the labels give the order."""
    frictions = sorted({run.friction for run in runs})
    plt.rcParams.update({"font.size": 15, "axes.titlesize": 16})
    figure, axes = plt.subplots(1, len(frictions), figsize=(14, 7), sharex=True, sharey=True)
    seen: dict[str, int] = {}
    for label in labels:
        program = label.split()[0]
        shade, marker = LOOKS[program]
        style = LINES[seen.setdefault(program, 0)]
        seen[program] += 1
        for friction, axis in zip(frictions, axes, strict=True):
            chosen = [r for r in runs if (r.label, r.friction) == (label, friction)]
            chosen.sort(key=lambda run: run.tolerance)
            axis.loglog(
                [1e3 * run.seconds for run in chosen],
                [run.error for run in chosen],
                style,
                color=shade,
                marker=marker,
                markersize=8,
                markerfacecolor=shade if style == "-" else "white",
                linewidth=3 if program == "evolvent" else 1.8,
                label=label + (", a case of 8" if label == "heyoka batch" else ""),
            )
    for friction, axis in zip(frictions, axes, strict=True):
        axis.set_title(f"f = {friction:g}")
        axis.set_xlabel("processor time of a case [ms]")
        axis.grid(which="major", color="#d0d0d0", linewidth=0.8)
        axis.set_ylim(1e-9, 1e-4)
    axes[0].set_ylabel("largest error of h / 2.967e-9 m")
    handles, names = axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="lower center", ncols=4, frameon=False)
    figure.tight_layout(rect=(0, 0.17, 1, 1))
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)
