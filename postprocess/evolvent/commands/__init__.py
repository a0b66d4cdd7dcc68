"""Command lines of evolvent-post and evolvent-sweep."""
