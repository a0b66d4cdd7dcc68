"""What is drawn of histories over time; `table` lists it."""
