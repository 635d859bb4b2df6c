"""What a mouse does to the grains."""
