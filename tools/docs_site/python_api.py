"""Reference of the Python package: its public functions and classes, by autodoc."""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from pathlib import Path
from typing import Any

# Classes of results, in no list of exports: module and name.
RESULTS = (
    ("evolvent.physics.invariants", "Verdict"),
    ("evolvent.physics.invariant", "Invariant"),
    ("evolvent.physics.invariant", "Deviation"),
    ("evolvent.physics.load_spectrum", "WheelSpectrum"),
    ("evolvent.physics.load_spectrum", "PointSpectrum"),
    ("evolvent.physics.load_cycles", "Cycles"),
    ("evolvent.physics.load_cycles", "SNLine"),
    ("evolvent.physics.turn_windows", "TurnWindow"),
    ("evolvent.history.recording", "Recording"),
    ("evolvent.history.recording", "Part"),
    ("evolvent.history.recording", "Variable"),
    ("evolvent.sweep.design", "Design"),
    ("evolvent.sweep.folder", "Shard"),
    ("evolvent.sweep.journal", "Records"),
    ("evolvent.sweep.journal", "Column"),
    ("evolvent.sweep.journal", "Counts"),
)
TITLES = {
    "evolvent": "evolvent: analyses and histories",
    "evolvent.history": "evolvent.history: result files",
    "evolvent.sweep": "evolvent.sweep: sweeps",
    "evolvent.physics": "evolvent.physics: results of checks and load spectra",
}
LEADS = {
    "evolvent": "Run analyses in the caller's process; open, check and compare their results."
    " :doc:`/docs/guides/calling` introduces these functions.",
    "evolvent.history": "Open result files of all kinds, as datasets or piece by piece."
    " :doc:`/docs/reference/result_format` describes the files.",
    "evolvent.sweep": "Run a sweep with an executor of your own. :doc:`/docs/guides/sweeps`"
    " introduces these functions.",
    "evolvent.physics": "Classes that :func:`evolvent.check_history` and"
    " :func:`evolvent.load_spectra` return.",
}
IMPORT = re.compile(r"^ *from (evolvent[.\w]*) import +(.+)$", re.MULTILINE)


def documented(root: Path) -> set[tuple[str, str]]:
    """Names that the snippets of the documents import from modules of the package."""
    pages = [root / "README.md", *sorted((root / "docs").rglob("*.md"))]
    return {
        (module, name.strip())
        for page in pages
        for module, names in IMPORT.findall(page.read_text(encoding="utf-8"))
        for name in names.split(",")
    }


def public(root: Path) -> dict[tuple[str, str], Any]:
    """Public functions and classes by the module to import them from and their name."""
    import evolvent
    import evolvent.history

    exported = [("evolvent", name) for name in evolvent.__all__]
    of_files = [("evolvent.history", name) for name in evolvent.history.__all__]
    found: dict[tuple[str, str], Any] = {}
    for module, name in [*exported, *of_files, *sorted(documented(root)), *RESULTS]:
        thing = getattr(import_module(module), name)
        if callable(thing) and thing not in found.values():
            found[module, name] = thing
    return found


def _page_of(module: str) -> str:
    return max((page for page in TITLES if module.startswith(page)), key=len)


def _directive(thing: Any) -> str:
    if inspect.isfunction(thing):
        return "autofunction"
    return "autoexception" if issubclass(thing, BaseException) else "autoclass"


ORDER = ("autofunction", "autoclass", "autoexception")


def pages(root: Path) -> dict[str, str]:
    """Pages of the package, by their path in the site."""
    things = public(root)
    made = {}
    for page, title in TITLES.items():
        members = [key for key in things if _page_of(key[0]) == page]
        members.sort(key=lambda key: (ORDER.index(_directive(things[key])), key))
        lines = [title, "=" * len(title), "", LEADS[page], ""]
        for key in members:
            name, directive = ".".join(key), _directive(things[key])
            lines += [f".. {directive}:: {name}"]
            lines += ["   :members:", ""] if directive == "autoclass" else [""]
        made[f"api/python/{page}.rst"] = "\n".join(lines) + "\n"
    return made
