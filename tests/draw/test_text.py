"""The bundled font: found, tabular, measured, shortened."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.draw import text
from sandbox.draw.text import BODY, SMALL, Type, font_path, page_scale
from sandbox.words import language


def test_fonts_and_their_licence_are_there() -> None:
    for bold in (False, True):
        path = font_path(bold)
        assert path.stat().st_size < 1_000_000
        assert "Open Font License" in (path.parent / "OFL.txt").read_text(encoding="utf-8")


def test_missing_font_says_where_it_was_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "_FILES", {False: "no.otf", True: "no.otf"})
    with pytest.raises(FileNotFoundError, match="assets"):
        font_path()


def test_installed_folder_comes_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    package = tmp_path / "sandbox" / "draw"
    (package / "fonts").mkdir(parents=True)
    (package / "fonts" / "SandboxSans-Regular.otf").touch()
    monkeypatch.setattr(text, "__file__", str(package / "text.py"))
    assert font_path() == package / "fonts" / "SandboxSans-Regular.otf"


@pytest.mark.parametrize("bold", [False, True])
@pytest.mark.parametrize("scale", [1.0, 1.5, 3.0])
def test_digits_have_one_width(scale: float, bold: bool) -> None:
    type_ = Type(scale)
    assert len({type_.width(digit * 8, BODY, bold) for digit in "0123456789"}) == 1


def test_every_sign_that_is_written_is_in_the_font() -> None:
    """One that is not is drawn as a box, as any other that is not."""
    import pygame.font
    import pygame.image

    pygame.font.init()
    tables = (str(language.table(code)) for code in language.available())
    written = {sign for table in tables for sign in table + table.upper()} | set("−—…νφ°²·")
    for bold in (False, True):
        font = pygame.font.Font(str(font_path(bold)), 16)
        drawn = {
            sign: pygame.image.tobytes(font.render(sign, True, (255, 255, 255)), "RGBA")
            for sign in (*sorted(written), "\uffff")
            if sign.isprintable() or sign == "\uffff"
        }
        box = drawn.pop("\uffff")
        assert [sign for sign, picture in drawn.items() if picture == box] == []


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0])
def test_no_text_below_14_pixels(scale: float) -> None:
    assert Type(scale).pixels(SMALL) >= 14


def test_shortened_text_fits() -> None:
    type_ = Type(1.0)
    long = "a sentence that is rather longer than its place"
    for width in range(0, 400, 7):
        assert type_.width(type_.shortened(long, BODY, width), BODY) <= width or width < 5
    assert type_.shortened("short", BODY, 400) == "short"
    assert type_.shortened(long, BODY, 2) == ""


def test_wrapped_lines_fit_and_keep_all_words() -> None:
    type_ = Type(1.0)
    lines = type_.wrapped("one two three four five six seven", BODY, 90)
    assert len(lines) > 2
    assert " ".join(lines) == "one two three four five six seven"
    assert all(type_.width(line, BODY) <= 90 for line in lines)


def test_rendered_text_is_kept_for_the_next_picture() -> None:
    type_ = Type(1.0)
    first = type_.render("word", BODY, 0xFFFFFF)
    assert type_.render("word", BODY, 0xFFFFFF) is first
    for index in range(600):
        type_.render(f"{index}", SMALL, 0)
    assert type_.render("word", BODY, 0xFFFFFF) is not first  # the cache is bounded


def test_page_scale_fits_the_window() -> None:
    assert page_scale(1.0, (480, 360)) == 1.0
    assert page_scale(3.0, (480, 360)) == 1.0
    assert page_scale(1.0, (3840, 2160)) == pytest.approx(1.3)
    assert page_scale(1.0, (100, 100)) == SMALL / BODY


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="where a system tells")
def test_no_font_keeps_a_file_open() -> None:
    """However many sizes of letters there have been; and the pictures are those of a font from the file."""
    import pygame.font
    import pygame.image

    opened = len(list(Path("/proc/self/fd").iterdir()))
    for size in range(20, 120):
        Type(size / BODY).render("Größe 12", BODY, 0xFFFFFF, bold=size % 2 == 0)
    assert len(list(Path("/proc/self/fd").iterdir())) == opened
    plain = pygame.font.Font(str(font_path()), 24).render("ν = −0.8", True, (255, 255, 255))
    mine = Type(1.5).render("ν = −0.8", BODY, 0xFFFFFF)
    assert pygame.image.tobytes(plain, "RGBA") == pygame.image.tobytes(mine, "RGBA")
