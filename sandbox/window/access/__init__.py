"""The window for who hears it or feels it: what is shown as a tree of plain data, and its way to screen readers."""
