"""Measurements that take minutes: how fast the program is, and how accurate."""
