"""Controls of the panel, as they look."""
