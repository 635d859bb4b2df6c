"""Study: error against run time."""
