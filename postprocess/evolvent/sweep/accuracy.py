"""Default accuracy of a sweep's cases, if neither the case nor the plan sets one."""

from __future__ import annotations

from collections.abc import Iterable

import yaml

ACCURACY = "1.0e-06"  # of the largest penetration
SAID_BY = ("simulation", "simulation.tolerance", "simulation.accuracy")  # paths of parameters


def with_accuracy(case: str, paths: Iterable[str | None]) -> str:
    """Insert the accuracy into the text of a case that has neither accuracy nor tolerance.

    The rest of the text is unchanged. An invalid text is returned as it is; the program rejects it.

    Parameters
    ----------
    case
        YAML, as the user wrote it.
    paths
        Of the parameters of the sweep: a parameter for accuracy or tolerance sets it for all cases.
    """
    if not set(SAID_BY).isdisjoint(paths):
        return case
    block = _simulation(case)
    if block is None or {key.value for key, _ in block.value} & {"tolerance", "accuracy"}:
        return case
    first = block.value[0][0].start_mark
    entry = f"accuracy: {ACCURACY}\n{' ' * first.column}"
    if block.flow_style:
        entry = f'"accuracy": {ACCURACY}, '  # JSON stays JSON
    return case[: first.index] + entry + case[first.index :]


def _simulation(case: str) -> yaml.MappingNode | None:
    """Return the block `simulation` with the locations of its keys; None if the text has none."""
    try:
        root = yaml.compose(case, Loader=yaml.SafeLoader)
    except yaml.YAMLError:
        return None
    for key, value in root.value if isinstance(root, yaml.MappingNode) else []:
        if key.value == "simulation" and isinstance(value, yaml.MappingNode) and value.value:
            return value
    return None
