"""Print a command of README.md, so that what is tested is what the README says.

    python3 readme_command.py test

The command is the one line of code after the marker ``<!-- command: test -->``.
"""

import re
import sys
from pathlib import Path

name = sys.argv[1]
readme = Path(__file__).parents[1] / "README.md"
pattern = rf"<!-- command: {re.escape(name)} -->\s*```\w*\n([^\n]+)\n```"
found = re.findall(pattern, readme.read_text(encoding="utf-8"))
if len(found) != 1:
    sys.exit(f"README.md has {len(found)} commands marked {name!r}, expected one")
print(found[0])
