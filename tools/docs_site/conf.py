"""Configuration of Sphinx for tools/build-docs, which prepares the pages."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from html import unescape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from latex2mathml.converter import convert_to_element

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]

project = "evolvent"
author = "evolvent contributors"
copyright = author
found = re.search(
    r"project\(\s*evolvent\s+VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()
)
assert found
version = release = found[1]

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
default_role = "literal"
exclude_patterns = ["files/**/*.py"]
myst_enable_extensions = ["dollarmath", "fieldlist", "html_image"]
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


FUNCTIONS = ("cos", "ln", "sin", "tan", "tanh")
SPACE = {"width": "0.17em"}


def _is_function(element: ET.Element) -> bool:
    base = element[0] if element.tag in ("msub", "msup", "msubsup") else element
    return base.tag == "mi" and base.text in FUNCTIONS


def _mathml(tex: str, display: str) -> str:
    """Convert a formula; functions get the space around them that TeX gives."""
    formula = convert_to_element(tex, display=display)
    for element in formula.iter():
        element.text = unescape(element.text or "")
    for row in [element for element in formula.iter() if element.tag in ("mrow", "mtd", "math")]:
        for element in [child for child in row if _is_function(child)]:
            index = list(row).index(element)
            following = row[index + 1].text if index + 1 < len(row) else ""
            if following not in ("(", ")", ",", ""):
                row.insert(index + 1, ET.Element("mspace", SPACE))
            if index > 0 and row[index - 1].tag not in ("mo", "mspace"):
                row.insert(index, ET.Element("mspace", SPACE))
    return ET.tostring(formula, encoding="unicode")


def _math(self: Any, node: nodes.math) -> None:
    self.body.append(_mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def _display(self: Any, node: nodes.math_block) -> None:
    self.body.append(f'<div class="math">{_mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Write formulas as MathML, which browsers draw without a script."""
    app.add_html_math_renderer("mathml", (_math, None), (_display, None))
