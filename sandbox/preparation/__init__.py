"""Compile kernels before somebody waits for them."""
