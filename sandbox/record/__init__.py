"""Films and tables of sessions, made without a window."""
