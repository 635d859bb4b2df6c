"""Solver threads, and what packings side by side have in common."""
