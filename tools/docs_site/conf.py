"""Configuration of Sphinx for tools/build-docs, which prepares the pages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from latex2mathml.converter import convert

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]

project = "evolvent"
author = "evolvent contributors"
copyright = author  # noqa: A001
found = re.search(
    r"project\(\s*evolvent\s+VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()
)
assert found
version = release = found[1]

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
exclude_patterns = ["files/**/*.py"]
myst_enable_extensions = ["dollarmath", "fieldlist"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 6

html_theme = "furo"
html_title = f"evolvent {version}"
html_copy_source = False
html_show_sphinx = False
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["site.css"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
numpydoc_show_class_members = False
# Types of other projects, and of C itself, have no page here.
nitpick_ignore_regex = [
    ("py:.*", r"(xr|np|xarray|numpy|pathlib|collections|concurrent|h5py|ctypes|typing)\..*"),
    ("py:.*", r"(Path|Any|Callable|Iterator|Mapping|Sequence|Executor|Values|Case|Settings)"),
    ("c:identifier", r"(size_t|u?int\d+_t|FILE)"),
]


def _math(self: Any, node: nodes.math) -> None:
    self.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _display(self: Any, node: nodes.math_block) -> None:
    self.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Write formulas as MathML, which browsers draw without a script."""
    app.add_html_math_renderer("mathml", (_math, None), (_display, None))
