"""What leads through the scenes: lessons and guided tours, as data."""
