"""Study: the claims of the paper."""
