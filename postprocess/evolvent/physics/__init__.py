"""What a history says of the mechanics: numbers, not figures."""
