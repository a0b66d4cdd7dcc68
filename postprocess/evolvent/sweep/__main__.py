"""`python -m evolvent.sweep`: the command evolvent-sweep."""

from evolvent.commands.sweep.app import main

main()
