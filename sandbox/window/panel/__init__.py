"""The panel at the side, section by section."""
