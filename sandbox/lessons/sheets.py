"""A lesson on paper: a worksheet for pupils, and apart from it aims, plan and answers for the teacher. Nothing in the pages runs.

They print on A4 and on Letter: the page's size is the printer's, and no block is cut.
"""

from __future__ import annotations

import html
from pathlib import Path

from core.errors import InputError
from sandbox.files.folder import write_bytes, write_text
from sandbox.lessons.lesson import Lesson, Predict, Said, Step
from sandbox.words import language, words
from sandbox.words.words import Section

SHEET = Section("lesson_sheet")
WIDE, HIGH, SQUARE = 640, 240, 20  # of the grid for a sketch, in its own units
SEEN_LINES = 2  # to write on after each step
STYLE = """
@page { margin: 16mm }
* { box-sizing: border-box }
body { font: 11pt/1.45 "Inter", "Segoe UI", "Helvetica Neue", Arial, sans-serif; color: #111; background: #fff; margin: 0 auto;
  max-width: 190mm; padding: 8mm }
h1 { font-size: 19pt; line-height: 1.2; margin: 0 0 4mm }
h2 { font-size: 13pt; margin: 7mm 0 2mm; break-after: avoid }
p, ul, ol { margin: 0 0 2mm }
.who { display: flex; gap: 8mm; margin: 0 0 5mm }
.who span { flex: 2; border-bottom: 1px solid #444; padding-bottom: 1mm }
.who span + span { flex: 1 }
.step, .task { break-inside: avoid; margin: 0 0 6mm; padding-left: 9mm; position: relative }
.step > b.number, .task > b.number { position: absolute; left: 0; width: 6.5mm; height: 6.5mm; line-height: 6.3mm;
  text-align: center; border: 1px solid #111; border-radius: 50% }
.label { font-weight: 600 }
ul.options { list-style: none; padding: 0 }
ul.options li { padding-left: 7mm; position: relative }
ul.options li::before { content: ""; position: absolute; left: 0; top: 1.1mm; width: 3.6mm; height: 3.6mm;
  border: 1px solid #111 }
.blank { display: inline-block; width: 34mm; border-bottom: 1px solid #444 }
.rule { height: 8.5mm; border-bottom: 1px solid #999 }
svg { display: block; width: 100%; max-width: 150mm; margin: 2mm 0 }
table { border-collapse: collapse; width: 100% }
th, td { border: 1px solid #999; padding: 1.5mm 2mm; text-align: left; vertical-align: top; font-size: 9.5pt }
tr { break-inside: avoid }
code { font: 10pt "DejaVu Sans Mono", Consolas, monospace; background: #eee; padding: 0 1mm }
@media print { body { padding: 0; max-width: none } }
"""


def write_sheets(lesson: Lesson, folder: Path, codes: tuple[str, ...] = ()) -> list[Path]:
    """Both pages in every language that the lesson speaks, or in some. Raises InputError where that cannot be written."""
    written = []
    for code in codes or languages_of(lesson):
        with language.speaking(code):
            pages = {"worksheet": worksheet(lesson), "teacher": teacher(lesson)}
        for kind, page in pages.items():
            path = folder / f"{lesson.name}-{kind}-{code}.html"
            write_text(path, page)
            written.append(path)
    return written


def languages_of(lesson: Lesson) -> tuple[str, ...]:
    """Those that the program has, and in which most of a lesson is written."""
    texts = [said for _, said in lesson.texts() if said]
    spoken = {
        code: sum(code in said.by_language for said in texts) for code in language.available()
    }
    return tuple(code for code, count in spoken.items() if 2 * count > len(texts))


def worksheet(lesson: Lesson) -> str:
    """What pupils get, in the present language."""
    parts = [
        f"<h1>{title_of(lesson)}</h1>",
        f'<p class="who"><span>{_text(SHEET["name"])}</span><span>{_text(SHEET["date"])}</span></p>',
        f"<p>{_text(str(lesson.about))}</p>" if lesson.about else "",
    ]
    parts += [_step(number, step) for number, step in enumerate(lesson.steps, 1)]
    if lesson.tasks:
        parts.append(f"<h2>{_text(SHEET['tasks'])}</h2>")
    for number, task in enumerate(lesson.tasks, 1):
        lines = '<div class="rule"></div>' * task.lines
        parts.append(_block("task", number, f"<p>{_text(str(task.text))}</p>{lines}"))
    return _page(title_of(lesson), "".join(parts))


def teacher(lesson: Lesson) -> str:
    """Aims, plan and answers, in the present language."""
    said = SHEET["length"].format(minutes=lesson.minutes) if lesson.minutes else ""
    head = f"{_text(SHEET['teacher'])}{' · ' if said else ''}{_text(said)}"
    name = _text(lesson.name)
    parts = [
        f"<h1>{title_of(lesson)}</h1><p>{head}</p>",
        _list("aims", lesson.aims),
        _list("prior", lesson.prior),
        f"<h2>{_text(SHEET['start'])}</h2>",
        f"<p>{_text(SHEET['start_text'])} <code>python -m sandbox play {name}.toml</code></p>",
        f"<p>{_text(SHEET['answers_text'])} <code>python -m sandbox play {name}.toml --answers FILE.csv</code></p>",
        f"<h2>{_text(SHEET['plan'])}</h2>{_plan(lesson)}",
    ]
    if lesson.tasks:
        answers = "".join(
            f"<li><p>{_text(str(task.text))}</p><p><b>{_text(str(task.answer))}</b></p></li>"
            for task in lesson.tasks
        )
        parts.append(f"<h2>{_text(SHEET['answers'])}</h2><ol>{answers}</ol>")
    return _page(f"{title_of(lesson)} – {_text(SHEET['teacher'])}", "".join(parts))


def title_of(lesson: Lesson) -> str:
    """On the page, escaped: that of the scene where the lesson has none."""
    return _text(str(lesson.title) or words.title(lesson.scene) or lesson.scene)


def _step(number: int, step: Step) -> str:
    parts = [f"<p>{_text(str(step.say))}</p>"]
    if step.predict is not None:
        label = f'<span class="label">{_text(SHEET["predict"])}:</span> ' if step.do else ""
        parts.append(f"<p>{label}{_text(str(step.predict.ask))}</p>{_room(step.predict)}")
    if step.do:
        parts.append(
            f'<p><span class="label">{_text(SHEET["do"])}:</span> {_text(str(step.do))}</p>'
        )
        parts.append(
            f'<p class="label">{_text(SHEET["seen"])}</p>' + '<div class="rule"></div>' * SEEN_LINES
        )
    return _block("step", number, "".join(parts))


def _room(predict: Predict) -> str:
    """Where an answer is written."""
    if predict.kind == "choice":
        items = "".join(f"<li>{_text(str(option))}</li>" for option in predict.options)
        return f'<ul class="options">{items}</ul>'
    if predict.kind == "number":
        return f'<p><span class="blank">&nbsp;</span> {_text(predict.unit)}</p>'
    return _grid(predict)


def _grid(predict: Predict) -> str:
    """Squared paper with the axes of a sketch."""
    left, top, foot = 56, 26, 44
    low, high, bottom, most = predict.axes
    lines = "".join(f"M{left + x} {top}V{top + HIGH}" for x in range(0, WIDE + 1, SQUARE))
    lines += "".join(f"M{left} {top + y}H{left + WIDE}" for y in range(0, HIGH + 1, SQUARE))
    along, up = (_text(str(name)) for name in predict.names)
    base = top + HIGH
    numbers = (
        (left, base + 18, "start", low), (left + WIDE, base + 18, "end", high),
        (left - 6, base, "end", bottom), (left - 6, top + 12, "end", most),
    )  # fmt: skip
    texts = "".join(
        f'<text x="{x}" y="{y}" font-size="14" text-anchor="{anchor}">{_number(value)}</text>'
        for x, y, anchor, value in numbers
    )
    return (
        f'<svg viewBox="0 0 {left + WIDE + 12} {base + foot}" role="img" aria-label="{up}, {along}">'
        f'<path d="{lines}" stroke="#111" stroke-opacity="0.3" fill="none"/>'
        f'<path d="M{left} {top - 8}V{base}H{left + WIDE + 8}" stroke="#111" stroke-width="2" fill="none"/>'
        f'{texts}<text x="{left}" y="14" font-size="14">{up}</text>'
        f'<text x="{left + WIDE}" y="{base + 36}" font-size="14" text-anchor="end">{along}</text></svg>'
    )


def _plan(lesson: Lesson) -> str:
    heads = ("step", "minutes", "asked", "right", "told")
    head = "".join(f'<th scope="col">{_text(SHEET[name])}</th>' for name in heads)
    rows = [
        (
            f"{number}. {step.say}",
            str(step.minutes or ""),
            "" if step.predict is None else str(step.predict.ask),
            "" if step.predict is None else _right(step.predict),
            " ".join(
                str(part)
                for part in ("" if step.predict is None else step.predict.answer, step.why)
                if part
            ),
        )
        for number, step in enumerate(lesson.steps, 1)
    ]
    left = lesson.minutes - sum(step.minutes for step in lesson.steps)
    if left > 0 and lesson.tasks:
        rows.append((SHEET["rest"], str(left), "", "", ""))
    body = "".join(
        "<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _right(predict: Predict) -> str:
    if predict.kind == "sketch":
        return SHEET["sketch"]
    if predict.right is None:
        return ""
    if predict.kind == "choice":
        return str(predict.options[round(predict.right)])
    within = f" ± {_number(predict.within)}" if predict.within else ""
    return f"{_number(predict.right)}{within} {predict.unit}".strip()


def _number(value: float) -> str:
    return f"{value:g}".replace("-", "−").replace(".", words.decimal_sign())


def _list(name: str, items: tuple[Said, ...]) -> str:
    if not items:
        return ""
    return f"<h2>{_text(SHEET[name])}</h2><ul>{''.join(f'<li>{_text(str(item))}</li>' for item in items)}</ul>"


def _block(kind: str, number: int, content: str) -> str:
    return f'<div class="{kind}"><b class="number">{number}</b>{content}</div>'


def _page(title: str, body: str) -> str:
    """A whole page, that loads nothing and runs nothing."""
    policy = "default-src 'none'; style-src 'unsafe-inline'"
    return (
        f'<!doctype html><html lang="{language.present()}"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title>'
        f"<style>{STYLE}</style></head><body>{body}</body></html>\n"
    )


def _text(text: str) -> str:
    return html.escape(text)


def copy_lesson(source: Path, folder: Path) -> Path:
    """The lesson itself beside its pages, to be played and changed. Raises InputError where somebody has changed it there."""
    target, lesson = folder / source.name, source.read_bytes()
    if not target.exists():
        write_bytes(target, lesson)
    elif target.read_bytes() != lesson:
        raise InputError(
            f"{target} is another lesson, perhaps one that you have changed: "
            "make its own sheets with lesson FILE, or give another folder"
        )
    return target
