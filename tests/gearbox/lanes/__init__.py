"""Rates and root functions of a gearbox in lanes, against those of single states."""
