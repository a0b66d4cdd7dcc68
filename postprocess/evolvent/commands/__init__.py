"""The command lines: evolvent-post and evolvent-sweep."""
