"""THE loop: commands in, bodies move, grains relax, a row and a frame out. No disk, no words, no screen."""
