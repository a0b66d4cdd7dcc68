"""Mutation testing: the list of mutants, their build folders, the tests run on them."""
