"""Ensembles of runs of one scene: many seeds, parameters along axes, one tidy row a run."""
