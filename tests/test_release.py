"""What is written about a release in several places is the same in all of them."""

from __future__ import annotations

import re
from pathlib import Path

from sandbox import __version__

REPOSITORY = Path(__file__).parents[1]


def text_of(name: str) -> str:
    return (REPOSITORY / name).read_text(encoding="utf-8")


def test_version_and_date_are_those_of_the_changelog() -> None:
    released = re.findall(
        r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2})$", text_of("CHANGELOG.md"), re.MULTILINE
    )
    citation = text_of("CITATION.cff")
    cited = [
        re.search(rf'^{key}: "?([^"\n]+)"?$', citation, re.MULTILINE)[1]  # type: ignore[index]
        for key in ("version", "date-released")
    ]
    assert list(released[0]) == cited
    assert __version__ == cited[0]
    assert [date for _, date in released] == sorted((d for _, d in released), reverse=True)


def test_the_form_for_bugs_shows_the_version() -> None:
    assert f"auxetic-sandbox {__version__}," in text_of(".github/ISSUE_TEMPLATE/bug.yml")
