"""Everything that a person touches: command line, window, films, replay. The rooms are shown in README.md beside this file."""

__version__ = "0.1.0"
