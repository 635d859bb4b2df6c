"""What the README says is true of the program."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from sandbox.cli import main as cli
from sandbox.words import words

REPOSITORY = Path(__file__).parents[1]
README = (REPOSITORY / "README.md").read_text(encoding="utf-8")


def command(name: str) -> str:
    """A command of the README, found as continuous integration finds it."""
    script = REPOSITORY / ".ci" / "readme_command.py"
    return subprocess.run(
        [sys.executable, str(script), name], capture_output=True, text=True, check=True
    ).stdout.strip()


def test_the_two_commands_are_one_line_each() -> None:
    assert command("start").startswith("python3 -m venv ")
    assert command("test").endswith("-m pytest -n auto --dist worksteal")


def test_the_first_command_can_be_run_with_and_without_a_screen() -> None:
    words = shlex.split(command("start"))
    played = words[words.index("sandbox") + 1 :]
    assert cli.parse(played).command == "play"
    instead = re.search(r"put `(record [^`]+)` in place of `([^`]+)`", README)
    assert instead
    assert instead[2] == " ".join(played)
    assert cli.parse(shlex.split(instead[1])).command == "record"


def test_every_option_is_in_the_summary_of_the_command_line() -> None:
    summary = re.search(r"```text\n(.+?)```", README, re.DOTALL)
    assert summary
    for name, parser in cli.parsers()[1].items():
        assert f"python -m sandbox {name}" in summary[1]
        for option in parser.options:
            assert option in summary[1] or option == "--help", option


def test_the_keys_are_those_of_the_help_page() -> None:
    controls = README.partition("## Controls")[2].partition("\n## ")[0]
    _, _, *keys = re.findall(r"^\| ([^|]+) \|", controls, re.MULTILINE)
    assert keys == [key for _, rows in words.help_groups() for key, _ in rows]


PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "sandbox/README.md",
    "scenes/README.md",
    "sandbox/notebook/README.md",
    "assets/studies/README.md",
)


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    path = REPOSITORY / page
    targets = re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8"))
    local = [target for target in targets if "://" not in target]
    assert local
    for target in local:
        assert (path.parent / target).exists(), target


def test_every_test_in_the_table_of_faults_is_there() -> None:
    text = (REPOSITORY / "tests" / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"`([a-z_/]+\.py)::(test_\w+)`", text)
    assert len(named) > 30
    for file, name in named:
        source = (REPOSITORY / "tests" / file).read_text(encoding="utf-8")
        assert f"def {name}(" in source, f"{file}::{name}"
