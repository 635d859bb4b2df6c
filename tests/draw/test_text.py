"""The bundled font: found, tabular, measured, shortened."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.draw import scripts, text
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


@pytest.mark.parametrize("width", [400.0, 150.0, 60.0, 3.0])
def test_names_that_differ_at_their_ends_still_do(width: float) -> None:
    type_ = Type(1.0)
    names = [f"mixed · seed 1 · number of grains 100 · orifice {d}" for d in ("2.2", "2.5")]
    names.append("auxetic" + names[0][5:])
    shown = [type_.elided(name, SMALL, width) for name in names]
    assert all(type_.width(each, SMALL) <= width for each in shown)
    if width > 100.0:
        assert len(set(shown)) == 3
    if width == 400.0:
        assert type_.elided("short", SMALL, width) == "short"


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


# -- other scripts --


@pytest.fixture
def other_font(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """One that is said to have all signs that the bundled one lacks."""
    path = str(font_path(bold=True))
    monkeypatch.setattr(scripts, "_found", lambda sign, bold: path)
    scripts.pieces.cache_clear()
    text._width.cache_clear()
    yield path
    scripts.pieces.cache_clear()
    text._width.cache_clear()


@pytest.mark.parametrize(
    ("whole", "seen"),
    [
        ("Größe ν Їжак", ["Größe ν Їжак"]),
        ("saved שלום עולם.scene", ["saved ", "<שלום עולם", ".scene"]),
        # numbers go to the right, in a line that goes to the left
        ("שלום 12 עולם", ["<עולם", "12", "<שלום"]),
        ("a שלום!", ["a ", "<שלום", "!"]),
        ("山田の箱 (2)", ["山田の箱 ", "(2)"]),
        ("e\u0301 ש\u05c1", ["e\u0301 ", "<ש\u05c1"]),  # marks stay with their letters
    ],
)
def test_pieces_stand_as_they_are_read(other_font: str, whole: str, seen: list[str]) -> None:
    content = font_path().read_bytes()
    found = scripts.pieces(whole, content)
    told = [f"<{piece.text.strip()}" if piece.leftward else piece.text for piece in found]
    assert [part for part in told if part != "<"] == seen  # "<": a space
    assert "".join(p.text for p in sorted(found, key=lambda piece: piece.start)) == whole
    foreign = {piece.font for piece in found if not piece.text.isascii()} - {""}
    assert foreign <= {other_font}


def test_a_line_of_several_fonts_is_as_high_as_any(other_font: str) -> None:
    type_ = Type(1.0)
    for whole in ("abc", "a שלום b", "山田"):
        shown = type_.render(whole, BODY, 0xFFFFFF)
        assert shown.get_size() == (type_.width(whole, BODY), type_.height(BODY))


def test_where_no_font_has_a_sign_the_bundled_one_stands_in(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("pygame.font.get_fonts", list)
    scripts._found.cache_clear()
    scripts.pieces.cache_clear()
    try:
        assert {piece.font for piece in scripts.pieces("a 山 ש", font_path().read_bytes())} == {""}
        assert Type(1.0).width("山", BODY) > 0
    finally:
        scripts._found.cache_clear()
        scripts.pieces.cache_clear()


def test_the_caret_goes_with_the_letters(other_font: str) -> None:
    """To the right, and to the left within what is written so; what is selected is where it is seen."""
    type_, whole = Type(1.0), "ab שלום"
    places = [type_.caret(whole, place, BODY) for place in range(len(whole) + 1)]
    assert places[:4] == sorted(places[:4])
    assert places[0] == 0
    right, left = type_.width(whole, BODY), places[-1]
    assert left == pytest.approx(type_.width("ab ", BODY), abs=1)
    assert places[4:] == sorted(places[4:], reverse=True)
    assert places[4] < right
    (first, last), (start, end) = type_.spans(whole, 1, 5, BODY)
    assert [first, last] == pytest.approx([places[1], places[3]], abs=1)
    assert [start, end] == pytest.approx([places[5], right], abs=1)
    assert type_.spans(whole, 2, 2, BODY) == []
