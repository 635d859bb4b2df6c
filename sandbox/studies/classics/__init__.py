"""Study: textbook and published cases."""
