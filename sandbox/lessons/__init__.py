"""What leads through the scenes: guided tours, as data."""
