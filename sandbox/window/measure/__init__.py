"""Measuring in the window: lengths, angles, the force through a cut, how forces and shapes are spread, a part of the curve."""
