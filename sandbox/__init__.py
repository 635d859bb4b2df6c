"""Everything that a person touches: command line, window, video, replay."""

__version__ = "0.1.0"
