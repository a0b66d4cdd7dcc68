"""The command evolvent-sweep status."""

from __future__ import annotations

import json
from typing import Annotated

from evolvent.commands.command_line import option
from evolvent.commands.program import say
from evolvent.commands.sweep import console
from evolvent.commands.sweep.common import Folder, OtherDesign


def status(
    directory: Folder,
    as_json: Annotated[bool, option("--json", "Write JSON, for scripts.")] = False,
    other_design: OtherDesign = None,
) -> None:
    """Show finished, failed and missing cases, reasons of failures, and the expected end time.

    \b
    Example:
      evolvent-sweep status torque
    """  # noqa: D301
    from evolvent.sweep import folder
    from evolvent.sweep.status import read_status

    found = read_status(directory, folder.design_of(directory, other_design))
    if as_json:
        say(json.dumps(console.status_as_json(found), indent=2))
    else:
        console.show_status(directory, found)
