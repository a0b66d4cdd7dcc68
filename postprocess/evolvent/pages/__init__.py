"""Output that combines physics and figures: drawings of gears, animations, reports."""
