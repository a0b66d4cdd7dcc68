"""Analyses of the program in this process: runs, static analyses, modes, contents of a case."""
