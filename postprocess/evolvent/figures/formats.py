"""Formats of figures: all that their options need to know."""

from enum import StrEnum


class Format(StrEnum):
    """Formats of a figure."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
