"""Figures of histories and other results; `table` lists them."""
