"""All that touches the disk: scene files, logs, autosaves, tables."""
