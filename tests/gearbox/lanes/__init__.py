"""The rates and root functions of a gearbox in lanes, against those of one state."""
