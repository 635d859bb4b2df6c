"""What the frozen program begins with."""

import multiprocessing

from sandbox.cli.main import program

if __name__ == "__main__":
    multiprocessing.freeze_support()
    raise SystemExit(program())
