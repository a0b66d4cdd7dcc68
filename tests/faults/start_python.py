"""Start a command of the Python programs: start_python.py {post,sweep} WORDS.

It stands in a folder of its own: what Python looks for in the folder of a test might not be found.
"""

import sys
from importlib import import_module

if __name__ == "__main__":
    name = sys.argv.pop(1)
    import_module(f"evolvent.commands.{name}.app").main()
