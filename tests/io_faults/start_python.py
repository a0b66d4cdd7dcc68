"""Start a command of the Python programs: start_python.py {post,sweep} WORDS.

With --many in place of that it reads commands from standard input, a line of JSON each, and runs
each in a process of its own, which has all modules already; warm.py speaks with it. It stands in a
folder of its own: what Python looks for in the folder of a test might not be found.
"""

import ctypes
import json
import os
import sys
from importlib import import_module
from typing import Any

LOADED = (
    *("evolvent.sweep.plan", "evolvent.sweep.collect", "evolvent.sweep.run"),
    *("evolvent.pages.report", "evolvent.figures.table", "evolvent.figures.style"),
    *("evolvent.commands.sweep.app", "evolvent.commands.post.app"),
)
UNUSED = ("dask", "pyarrow")  # programs do without them, too


def become(given: dict[str, Any]) -> None:
    """Make this process, which was just forked, that of a command."""
    for number, name, flags in (
        (0, os.devnull, os.O_RDONLY),
        (1, given["output"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC),
        (2, given["errors"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC),
    ):
        descriptor = os.open(name, flags, 0o666)
        os.dup2(descriptor, number)
        os.close(descriptor)
    os.chdir(given["folder"])
    os.environ.clear()
    os.environ.update(given["environment"])
    sys.argv[1:] = given["words"]
    ctypes.CDLL(None).layer_begin()  # calls are counted from here on


def serve() -> None:
    """Start what is asked for; comes back in the process of a command, and at the end of all."""
    sys.modules.update(dict.fromkeys(UNUSED))
    for name in LOADED:
        import_module(name)
    import_module("xarray").backends.list_engines()
    for line in sys.stdin:
        pid = os.fork()
        if pid == 0:
            become(json.loads(line))
            return
        os.write(1, b"%d\n" % pid)
        code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        os.write(1, b"%d\n" % code)
    sys.exit()


if __name__ == "__main__":
    if sys.argv[1] == "--many":
        serve()
    program = sys.argv.pop(1)
    import_module(f"evolvent.commands.{program}.app").main()
