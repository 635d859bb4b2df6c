"""Study: what a hand can move, whether tours keep their word, what random hands can break."""
