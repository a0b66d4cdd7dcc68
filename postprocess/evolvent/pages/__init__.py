"""What takes physics and figures together: pictures of gears, moving pictures, reports."""
