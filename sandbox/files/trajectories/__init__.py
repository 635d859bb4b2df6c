"""Trajectories for other people's programs: extended XYZ, NumPy arrays, VTK's PolyData."""
