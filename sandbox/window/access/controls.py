"""The controls of panel and time line as nodes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from sandbox.draw.numbers import number
from sandbox.draw.widgets.controls import (
    Bars,
    Button,
    Choice,
    Fact,
    Heading,
    Note,
    Place,
    Simple,
    Slider,
    Stepper,
    Switch,
    TextField,
)
from sandbox.window.access.node import Do, Edges, Node, Number, changes, edges
from sandbox.window.sections import Value
from sandbox.words import words

OPTION = "#"  # between the name of a choice and an option's value

Use = Callable[[str, Value], None]
Go = Callable[[str], None]


def nodes_of(
    places: Sequence[Place], shift: tuple[int, int], use: Use, go: Go
) -> Iterator[tuple[Node, Sequence[Node]]]:
    """Every control, with what is within it. ``shift``: of the places, into the window [px]."""
    for index, place in enumerate(places):
        control = place.control
        name, rect = control.name or f"text/{index}", edges(place.rect.move(shift))
        if isinstance(control, Choice):
            yield _choice(control, rect, use, go)
        else:
            yield _node(control, partial(Node, name, rect=rect), name, use, go), ()


def _node(control: Simple, made: Callable[..., Node], name: str, use: Use, go: Go) -> Node:
    """``made``: a node of that name at its place, from its role and all else."""
    about, focus = control.help, {"FOCUS": lambda _: go(name)}
    does: dict[str, Do]
    match control:
        case Slider():
            return _slider(control, made, focus, use)
        case Stepper(title=title, value=value):
            scale = Number(float(value), float(control.low), float(control.high), 1.0)
            does = focus | changes(scale, lambda value: use(name, round(value)))
            return made("SPIN_BUTTON", title, str(value), about, scale, does=does)
        case Switch(title=title, on=on):
            does = focus | {"CLICK": lambda _: use(name, not on)}
            return made("SWITCH", title, about=about, on=on, does=does)
        case Button(enabled=enabled):
            does = focus | {"CLICK": lambda _: use(name, True)} if enabled else {}
            title = control.spoken or control.title
            about = _more(about, title)
            return made("BUTTON", title, about=about, on=control.on, enabled=enabled, does=does)
        case TextField():
            does = focus | {"SET_VALUE": lambda value: use(name, str(value))}
            title = control.title or words.first_sentence(about)
            return made("TEXT_INPUT", title, control.text, _more(about, title), does=does)
        case Heading(title=title, open=is_open):

            def fold(wanted: bool) -> None:
                if wanted != is_open:
                    use(name, wanted)

            does = focus | {"CLICK": lambda _: fold(not is_open)}
            does |= {"EXPAND": lambda _: fold(True), "COLLAPSE": lambda _: fold(False)}
            # A button that is "on" is heard as pressed, where "expanded" is not told.
            return made("BUTTON", title, open=is_open, on=is_open, does=does)
        case Fact(title=title, value=said):
            return made("LABEL", text=f"{title}: {said}" if said else title)
        case Bars():
            shares = words.LIST_SIGN.join(number(100.0 * share, 0) for share in control.shares)
            bars = words.BARS_TOLD.format(low=control.low, high=control.high, shares=shares)
            return made("LABEL", text=f"{control.title}: {control.value}. {bars}")
        case Note(text=text):
            return made("LABEL", text=text)
    return made("LABEL")


def _more(about: str, title: str) -> str:
    """What a help says that is not in the name already: both are heard, one after the other."""
    bare = title.removesuffix(".")
    again = about.lower() == bare.lower() or about.lower().startswith(f"{bare}.".lower())
    return about[len(bare) + 1 :].lstrip() if again else about


def _slider(slider: Slider, made: Callable[..., Node], focus: Mapping[str, Do], use: Use) -> Node:
    name, value, scale = slider.name, slider.value, slider.range
    step = abs(scale.stepped(value, 1 if value < slider.high else -1) - value)
    reach = Number(value, slider.low, slider.high, step)
    does = {**focus, **changes(reach, lambda value: use(name, value))}
    does |= {"INCREMENT": lambda _: use(name, scale.stepped(value, 1))}
    does |= {"DECREMENT": lambda _: use(name, scale.stepped(value, -1))}
    # Not every system tells the unit with the value.
    about = f"[{slider.unit}] {slider.help}" if slider.unit else slider.help
    text = f"{slider.said} {slider.unit}".rstrip()
    return made("SLIDER", slider.title, text, about, reach, does=does)


def _choice(choice: Choice, rect: Edges, use: Use, go: Go) -> tuple[Node, Sequence[Node]]:
    name, title, about = choice.name, choice.title, choice.help
    if not title:
        title, about = about, ""
    focus: dict[str, Do] = {"FOCUS": lambda _: go(name)}

    def option(value: str, said: str) -> Node:
        does = focus | {"CLICK": lambda _: use(name, value)}
        on = value == choice.value
        return Node(f"{name}{OPTION}{value}", "RADIO_BUTTON", said, on=on, rect=rect, does=does)

    options = [option(each.value, each.title) for each in choice.options]
    names = tuple(each.name for each in options)
    group = Node(name, "RADIO_GROUP", title, "", about, rect=rect, children=names, does=focus)
    return group, options


def chosen(name: str, nodes: Mapping[str, Node]) -> str:
    """The radio button that is on, for a group that has the keyboard; the name itself for anything else."""
    group = nodes.get(name)
    if group is None or group.role != "RADIO_GROUP":
        return name
    return next((child for child in group.children if nodes[child].on), name)
