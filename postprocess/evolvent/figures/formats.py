"""File formats of figures."""

from enum import StrEnum


class Format(StrEnum):
    """Format of a figure."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
