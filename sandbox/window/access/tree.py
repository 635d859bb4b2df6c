"""All that the window shows, as one tree: what runs with its handles, plot and status, card, time line, panel; or a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from sandbox.draw.pages.menu_layout import DISCARD, SCENE, START, TAKE_UP, TOUR
from sandbox.draw.pages.tour_card import FIELD, OPTION
from sandbox.draw.widgets.controls import Heading
from sandbox.session.frame import Frame
from sandbox.window.access import explore
from sandbox.window.access.controls import chosen, nodes_of
from sandbox.window.access.handles import hand_keys, nodes_of_handle
from sandbox.window.access.node import ROOT, Do, Node, Number, button, changes, edges, label
from sandbox.window.access.readings import frames_of, nodes_of_readings, nodes_of_sketch
from sandbox.window.actions import Actions
from sandbox.window.asking import Asking
from sandbox.window.canvas.arrows import Arrows
from sandbox.window.focus import CANVAS
from sandbox.window.guide import Guide
from sandbox.window.keys import Action
from sandbox.window.pages import Pages
from sandbox.window.panel.panel import Panel
from sandbox.window.picture import told_of
from sandbox.window.question import ExportQuestion
from sandbox.window.sections import Value
from sandbox.window.sketched import pen, told
from sandbox.window.stage import Stage
from sandbox.window.timeline import BAR, Timeline
from sandbox.words import words


@dataclass
class Parts:
    """Of the window, that the tree is made from."""

    stage: Stage
    pages: Pages
    actions: Actions
    guide: Guide
    panel: Panel
    timeline: Timeline
    arrows: Arrows
    question: ExportQuestion


class Tree:
    """The nodes by name, what stands at the top, and what has the keyboard; made anew for every look."""

    def __init__(self, parts: Parts, live: Sequence[Node] = ()) -> None:
        """``live``: what is being said."""
        self._parts = parts
        self.nodes: dict[str, Node] = {}
        self._top: list[str] = []
        stage = parts.stage
        if stage.show_help:
            self.focus = self._help()
        elif stage.show_explore:
            self.focus = self._explore()
        elif stage.show_menu:
            self.focus = self._menu()
        else:
            self.focus = self._run()
        for node in live:
            self._at_top(node)
        size = stage.screen.get_size()
        title, children = words.SPLASH_TITLE, tuple(self._top)
        self.nodes[ROOT] = Node(ROOT, "WINDOW", title, rect=(0, 0, *size), children=children)
        if self.focus not in self.nodes:
            self.focus = ROOT

    def _add(self, *nodes: Node) -> None:
        self.nodes.update({node.name: node for node in nodes})

    def _at_top(self, node: Node, within: Sequence[Node] = ()) -> None:
        """A node of the window itself, and the nodes in it."""
        self._add(node, *within)
        self._top.append(node.name)

    def _group(self, name: str, role: str, title: str, inside: list[Node], **more: Any) -> None:
        """Several nodes in one of the window itself."""
        children = tuple(node.name for node in inside)
        self._at_top(Node(name, role, title, children=children, **more), inside)

    def _act(self, action: Action) -> Callable[[], None]:
        return lambda: self._parts.actions.act(action)

    # -- pages --

    def _help(self) -> str:
        rows = [
            label(f"help/{key}", f"{title}. {key}: {does}")
            for title, group in words.help_groups()
            for key, does in group
        ]
        close = button("help/close", words.CLOSE, self._act(Action.HELP))
        self._group("help", "DOCUMENT", words.HELP_TITLE, [close, *rows])
        return close.name

    def _explore(self) -> str:
        page = self._parts.pages.explore
        close = button("explore/close", words.CLOSE, self._act(Action.BACK))
        self._group(explore.NAME, "GROUP", page.title, [close, *explore.nodes_of_explore(page)])
        return explore.chosen(page)

    def _menu(self) -> str:
        pages, stage = self._parts.pages, self._parts.stage
        menu = pages.menu
        contents = menu.contents(stage.panes.packing, stage.renderer.theme.name)

        def press(name: str) -> Callable[[], None]:
            return lambda: self._parts.actions.choose(name)

        def add(name: str, title: str, about: str = "", on: bool | None = None) -> None:
            does: dict[str, Do] = {"FOCUS": lambda _: menu.go(name)}
            rect = edges(menu.place_of(name))
            self._at_top(button(name, title, press(name), about=about, on=on, rect=rect, does=does))

        self._at_top(label("title", words.MENU_TITLE))
        if contents.resume:
            self._at_top(label("left", contents.resume))
            add(TAKE_UP, words.TAKE_UP, contents.resume)
            add(DISCARD, words.DISCARD, contents.resume)
        if contents.start:
            add(START, f"{words.START_HERE}: {words.START_QUESTION}", words.START_ABOUT)
        for card in contents.cards:
            add(card.name, card.title, f"{card.question} {card.about}".strip())
            if card.tour:
                add(TOUR + card.name.removeprefix(SCENE), f"{words.TOUR}: {card.title}")
        for chip in contents.chips:
            add(chip.name, chip.text, on=chip.on if chip.name.startswith("packing/") else None)
        return menu.chosen

    # -- what runs --

    def _run(self) -> str:
        parts, stage = self._parts, self._parts.stage
        snapshot = stage.panes.snapshot
        if snapshot.phase == "failed":
            self._at_top(label("failed", f"{words.ERROR_TITLE}: {words.say(snapshot.error)}"))
            self._at_top(button("failed/reset", words.BUTTONS["reset"], self._act(Action.RESET)))
            self._at_top(button("failed/menu", words.BUTTONS["menu"], self._act(Action.MENU)))
            return "failed/reset"
        frames = [pane[0] for pane in stage.picture.panes()]
        self._told()
        if not frames:
            self._at_top(button("cancel", words.CANCEL, self._act(Action.BACK)))
            return "cancel"
        if parts.question.asking:
            return self._question()
        if parts.guide.on:
            self._card()
        self._canvas(frames)
        self._time()
        self._panel()
        focus = stage.focus.name
        if focus == CANVAS or (focus.startswith(CANVAS) and focus not in self.nodes):
            focus = next((name for name in self.nodes if name.startswith(focus + "/")), CANVAS)
        return chosen(focus, self.nodes)

    def _told(self) -> None:
        """Of every pane: what is being built, or that it came to an error."""
        panes = self._parts.stage.panes
        for k, (packing, snapshot) in enumerate(zip(panes.packings, panes.snapshots, strict=True)):
            name = f"{words.PACKINGS.get(packing, packing)}: " if panes.comparing else ""
            for text in told_of(snapshot):
                self._at_top(label(f"told/{k}", f"{name}{text}"))

    def _question(self) -> str:
        question = self._parts.question
        answers = [
            button(f"question/{k}", title, lambda k=k: question.answer(k), about=about)  # type: ignore[misc]
            for k, (title, about) in enumerate(question.answers())
        ]
        self._group("question", "DIALOG", words.EXPORT_ASK, answers)
        return f"question/{question.place}"

    def _card(self) -> None:
        guide = self._parts.guide
        page = guide.page
        step = words.TOUR_STEP.format(step=page.step + 1, steps=page.steps)
        do = f"{words.TOUR_DONE}: {page.do}" if page.done and page.do else page.do
        texts = [page.say, do, page.why]
        nodes = [label(f"tour/text/{k}", text) for k, text in enumerate(texts) if text]
        options: list[Node] = []

        def press(name: str) -> Callable[[], None]:
            return lambda: guide.press(name)

        for name in guide.stops():
            does: dict[str, Do] = {"FOCUS": lambda _, name=name: self._go(name)}  # type: ignore[misc]
            if name.startswith(OPTION):
                index = int(name.removeprefix(OPTION))
                on = page.chosen == index
                does |= {"CLICK": lambda _, name=name: guide.press(name)}  # type: ignore[misc]
                title = page.options[index]
                options.append(Node(name, "RADIO_BUTTON", title, on=on, does=does))
            elif name == FIELD and page.field is not None:
                does |= {"SET_VALUE": self._fill}
                title = f"{page.ask} [{page.field.unit}]" if page.field.unit else page.ask
                text, about = page.field.text, page.hint
                nodes.append(Node(name, "TEXT_INPUT", title, text, about, does=does))
            elif name in guide.titles:
                nodes.append(button(name, guide.titles[name], press(name), does=does))
            else:
                # Of such a thing no system tells the value.
                about = f"{self._sketch(guide.asking)} {page.hint}".strip()
                nodes.append(Node(name, "CANVAS", page.ask, about=about, does=does))
        if options:  # a reader says the question with them, and how many there are
            self._add(*options)
            names = tuple(node.name for node in options)
            nodes.insert(1, Node(OPTION, "RADIO_GROUP", page.ask, children=names))
        self._group("tour", "GROUP", f"{page.title}, {step}", nodes, rect=edges(guide.rect))

    def _sketch(self, asking: Asking) -> str:
        """What is drawn so far, and where the pen is."""
        frames = frames_of(self._parts.stage)
        if asking.sketch is None or not frames:
            return ""
        texts = told(asking.sketch, frames[0]), pen(asking.sketch)
        return " ".join(filter(None, texts))

    def _fill(self, value: object) -> None:
        """The number that a lesson asks for."""
        self._parts.guide.asking.number.fill(str(value))

    def _canvas(self, frames: list[Frame]) -> None:
        """What runs: all that is read off it; and the handles, for the arrow keys and as sliders."""
        stage, frame = self._parts.stage, frames[0]
        title = words.title(frame.scene, frame.title)
        asking = self._parts.guide.asking
        nodes = [*nodes_of_readings(stage), *nodes_of_sketch(asking, frames)]
        for handle in frame.handles:
            state = self._parts.arrows.state_of(handle.name) or handle
            nodes += nodes_of_handle(state, frame, self._parts.arrows, self._take)
        places = stage.picture.panes()
        about = hand_keys() if frame.handles else ""
        self._group(CANVAS, "CANVAS", title, nodes, about=about, rect=edges(places[0][2]))

    def _take(self, name: str) -> bool:
        """A handle, to be led; not before a question is answered."""
        if self._parts.guide.asking.refuses():
            return False
        self._go(name)
        return True

    def _time(self) -> None:
        timeline = self._parts.timeline
        bar = timeline.bar()
        if bar is None:
            return  # then it is in the panel
        for node, within in nodes_of(
            timeline.places().all,
            (0, 0),
            lambda name, value: timeline.use(name, value, True),
            self._go,
        ):
            self._at_top(node, within)
        number = Number(float(bar.now), float(bar.first), float(bar.last), 1.0)
        does: dict[str, Do] = {"FOCUS": lambda _: self._go(BAR)}
        does |= changes(number, lambda value: timeline.go_to(round(value)))
        text = words.INCREMENT.format(increment=bar.now)
        rect = edges(bar.rect)
        self._at_top(Node(BAR, "SLIDER", words.TIME_LINE, text, "", number, rect=rect, does=does))

    def _panel(self) -> None:
        panel = self._parts.panel
        if not panel.drawer.shown:
            self._at_top(button("unfold", words.UNFOLD, panel.fold, rect=edges(panel.drawer.tab)))
            return
        headings = {p.control.name for p in panel.places if isinstance(p.control, Heading)}

        def use(name: str, value: Value) -> None:
            if name in headings:
                panel.toggle(name)
            else:
                panel.use(name, value, True)

        shift = panel.rect.left, panel.rect.top - panel.scroll
        inside = []
        for node, within in nodes_of(panel.places, shift, use, self._go):
            self._add(node, *within)
            inside.append(node.name)
        node = Node("panel", "PANE", words.PANEL, rect=edges(panel.rect), children=tuple(inside))
        self._at_top(node)

    def _go(self, name: str) -> None:
        self._parts.stage.focus.go(name, True)
