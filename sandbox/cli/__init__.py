"""The command line: words to options to exit codes."""
