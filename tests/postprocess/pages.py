"""What the tests read out of an interactive page, without a browser."""

from __future__ import annotations

import base64
import gzip
import json
import re
from typing import Any

import numpy as np


def script(page: str, name: str) -> str:
    """Content of a script element by its name."""
    (content,) = re.findall(rf'<script type="[^"]*" id="explorer-{name}">(.*?)</script>', page)
    return content


def unpacked(text: str) -> bytes:
    return gzip.decompress(base64.b64decode(text))


def read_lines(page: str) -> dict[str, dict[str, Any]]:
    """Quantities of a page by name: unit, and `lines`: label, times, values, as they are shown."""
    facts = json.loads(script(page, "facts"))
    content = unpacked(script(page, "numbers"))
    times = np.frombuffer(content, "<f8", facts["times"])
    offset = times.nbytes
    found = {}
    for quantity in facts["quantities"]:
        lines = {}
        for line in quantity["lines"]:
            rows = np.cumsum(np.frombuffer(content, "<u4", line["size"], offset))
            values = np.frombuffer(content, "<f4", line["size"], offset + rows.size * 4)
            offset += rows.size * 8
            lines[line["label"]] = (times[rows], values)
        found[quantity["name"]] = {**quantity, "lines": lines}
    assert offset == len(content)
    return found
