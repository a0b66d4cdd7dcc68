"""The command line: stage the pages, run Sphinx, check the links of the result."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

from docs_site import c_headers, fortran_modules, links, python_api, staging

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("furo", "latex2mathml", "myst_parser", "numpydoc", "sphinx")


def _missing() -> list[str]:
    """Packages of the extra `docs` that are not installed."""
    from importlib.util import find_spec

    return [name for name in MODULES if find_spec(name) is None]


def _write(source: Path) -> None:
    """Write all pages of the site, in the form that Sphinx reads."""
    pages = {
        **python_api.pages(ROOT),
        **c_headers.pages(ROOT),
        **fortran_modules.pages(ROOT),
    }
    staging.write(ROOT, source, pages)


def build(output: Path) -> int:
    """Build the site in a folder; return 0, or 1 after a warning of Sphinx or a broken link."""
    if (output / ".buildinfo").is_file():  # an older site may have other pages
        shutil.rmtree(output)
    source = output.with_name(f"{output.name}-source")
    _write(source)
    sphinx = [sys.executable, "-m", "sphinx", "--builder", "html", "--conf-dir"]
    strict = ["--fail-on-warning", "--nitpicky", "--quiet", "--color"]
    python_path = os.pathsep.join(
        [str(ROOT / "postprocess"), str(ROOT / "tools"), os.environ.get("PYTHONPATH", "")]
    )
    done = subprocess.run(
        [*sphinx, str(Path(__file__).parent), *strict, str(source), str(output)],
        env={**os.environ, "PYTHONPATH": python_path.rstrip(os.pathsep)},
        check=False,
    )
    broken = links.broken(output)
    print(*broken, sep="\n", end="\n" if broken else "", file=sys.stderr)
    return 1 if done.returncode or broken else 0


def main() -> int:
    """Build the site."""
    parser = argparse.ArgumentParser(
        prog="tools/build-docs",
        description="Build the documentation as a site with a search and the references of Python,"
        " C and Fortran. Open OUTPUT/index.html. A warning or a broken link is an error.",
    )
    parser.add_argument(
        "output",
        metavar="OUTPUT",
        nargs="?",
        type=Path,
        default=ROOT / "build" / "site",
        help="folder of the site (default: build/site)",
    )
    output = parser.parse_args().output.resolve()
    if missing := _missing():
        print(
            f"tools/build-docs: no Python package {', '.join(missing)};"
            " install them: pip install '.[docs]'",
            file=sys.stderr,
        )
        return 2
    code = build(output)
    if code == 0:
        print(output / "index.html")
    return code
