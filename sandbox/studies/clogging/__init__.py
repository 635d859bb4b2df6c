"""Clogging as an experiment."""
