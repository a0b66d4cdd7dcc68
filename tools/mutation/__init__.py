"""Mutants of the code: the list, where they are built, what is run on them."""
