"""The program from Python: ``run`` a scene, and look at what came of it. README.md beside this file shows how."""

from sandbox.notebook.runs import Columns, Result, run

__all__ = ["Columns", "Result", "run"]
