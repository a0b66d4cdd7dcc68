"""Evaluation of the mechanics of a history: numerical results, no figures."""
