"""`python -m evolvent.commands.sweep`: the command evolvent-sweep, as jobs of a cluster call it."""

from evolvent.commands.sweep.app import main

main()
