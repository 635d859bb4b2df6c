"""Explore: a map over two parameters that fills while one looks."""
