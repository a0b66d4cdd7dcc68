"""`python -m evolvent.sweep`: the command evolvent-sweep."""

from evolvent.sweep.cli import main

main()
