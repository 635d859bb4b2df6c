"""``python -m sandbox``."""

from sandbox.cli.main import program

if __name__ == "__main__":
    raise SystemExit(program())
