"""`python -m evolvent.commands.sweep`: the command evolvent-sweep, as cluster jobs call it."""

from evolvent.commands.sweep.app import main

main()
