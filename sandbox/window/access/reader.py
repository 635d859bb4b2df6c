"""The way to screen readers, by AccessKit: the tree goes out as it changes, and what is asked of a node is done.

AccessKit is an extra; without it, and as long as nobody listens, there is nothing to do.
"""

from __future__ import annotations

import queue
import sys
from typing import Any

import pygame

from sandbox.window.access.node import ROOT, Node
from sandbox.window.access.speech import Speech
from sandbox.window.access.tree import Parts, Tree
from sandbox.window.display import show_display

try:
    import accesskit
except ImportError:
    accesskit = None

EVERY = 0.1  # the tree is compared this often [s]


class Reader:
    """Publishes what has changed, and carries out what is asked."""

    def __init__(self, parts: Parts) -> None:
        self.parts = parts
        self._speech = Speech(parts.stage, parts.guide)
        self._reader: Any = None  # what the one that is there was given when it came
        self._served: Any = None  # and the one that was told all
        self._nodes: dict[str, Node] = {}  # of the latest look
        self._sent: dict[str, Node] = {}
        self._focus = ROOT
        self._live: tuple[Node, ...] = ()
        self._spoken = 0
        self._ids = {ROOT: 1}
        self._asked: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._due = 0.0
        self._adapter: Any = None if accesskit is None else self._adapt()
        show_display()

    def _adapt(self) -> Any:
        if sys.platform == "win32":
            window = pygame.display.get_wm_info()["window"]
            return accesskit.windows.SubclassingAdapter(window, self._come, self._asked.put)
        if sys.platform == "darwin":
            accesskit.macos.add_focus_forwarder_to_window_class("SDLWindow")
            window = pygame.display.get_wm_info()["window"]
            return accesskit.macos.SubclassingAdapter.for_window(
                window, self._come, self._asked.put
            )
        return accesskit.unix.Adapter(self._come, self._asked.put, self._leave)

    # -- told by AccessKit, perhaps in a thread of its own --
    # As a reader comes, that thread holds a lock while it waits for the interpreter; whoever sends something meanwhile holds the
    # interpreter and waits for that lock, and the window stands still for ever. So nothing is sent before ``_come`` is done.

    def _come(self) -> Any:
        """A reader is there: it gets the window, and soon what is in it."""
        update = accesskit.TreeUpdate(self._ids[ROOT])
        update.nodes.append((self._ids[ROOT], accesskit.Node(accesskit.Role.WINDOW)))
        update.tree = accesskit.Tree(self._ids[ROOT])
        update.tree.toolkit_name = "auxetic-sandbox"
        self._reader = update  # the last that is done here
        return update

    def _leave(self) -> None:
        self._reader = None

    # -- once a picture --

    def watch(self, event: pygame.event.Event) -> None:
        """The window got the keyboard, or lost it, or is elsewhere."""
        if self._reader is None:
            return
        if event.type in (pygame.WINDOWMOVED, pygame.WINDOWSIZECHANGED, pygame.WINDOWSHOWN):
            self._tell_place()
        elif event.type in (pygame.WINDOWFOCUSGAINED, pygame.WINDOWFOCUSLOST):
            self._tell_keyboard(event.type == pygame.WINDOWFOCUSGAINED)

    def _tell_place(self) -> None:
        """Where the window is on the screen, which AT-SPI does not know by itself."""
        if sys.platform not in ("win32", "darwin"):
            (left, top), (width, height) = (
                pygame.display.get_window_position(),
                pygame.display.get_window_size(),
            )
            place = accesskit.Rect(*map(float, (left, top, left + width, top + height)))
            self._adapter.set_root_window_bounds(place, place)

    def _tell_keyboard(self, has_it: bool) -> None:
        if sys.platform == "darwin":
            self._raise(self._adapter.update_view_focus_state(has_it))
        elif sys.platform != "win32":
            self._adapter.update_window_focus_state(has_it)

    def tick(self, now: float) -> None:
        """Do what was asked, and tell what has changed."""
        reader = self._reader
        if reader is None:
            return
        if reader is not self._served:  # whoever comes gets all of it
            self._served, self._sent, self._due = reader, {}, now
            self._tell_place()
            self._tell_keyboard(pygame.key.get_focused())
        while not self._asked.empty():
            self._do(self._asked.get())
            self._due = now
        if now >= self._due:
            self._due = now + EVERY
            self._send()

    def _send(self) -> None:
        """The nodes that differ from what was sent last."""
        if self._sent:
            said = tuple(self._speech.new())
        else:
            self._speech.begin()
            said = ()
        if said:  # a node of its own each time: the same words twice are heard twice
            self._spoken += 1
            self._live = (Node(f"said/{self._spoken}", "LABEL", text="\n".join(said), live=True),)
        tree = Tree(self.parts, self._live)
        new = {name: node for name, node in tree.nodes.items() if self._sent.get(name) != node}
        self._nodes = tree.nodes
        if not new and tree.focus == self._focus:
            return
        self._sent, self._focus = tree.nodes, tree.focus
        self._raise(self._adapter.update_if_active(lambda: self._update(new, tree.focus)))

    @staticmethod
    def _raise(events: Any) -> None:
        if events is not None:
            events.raise_events()

    def _update(self, nodes: dict[str, Node], focus: str) -> Any:
        update = accesskit.TreeUpdate(self._id(focus))
        update.nodes.extend((self._id(name), self._made(node)) for name, node in nodes.items())
        return update

    def _id(self, name: str) -> int:
        return self._ids.setdefault(name, len(self._ids) + 1)

    def _made(self, node: Node) -> Any:
        """A node as AccessKit has it."""
        made = accesskit.Node(getattr(accesskit.Role, node.role))
        made.set_author_id(node.name)
        texts = (made.set_label, node.label), (made.set_value, node.text)
        for put, text in (*texts, (made.set_description, node.about)):
            if text:
                put(text)
        if node.number is not None:
            made.set_numeric_value(node.number.value)
            made.set_min_numeric_value(node.number.low)
            made.set_max_numeric_value(node.number.high)
            made.set_numeric_value_step(node.number.step)
        if node.on is not None:
            made.set_toggled(accesskit.Toggled.TRUE if node.on else accesskit.Toggled.FALSE)
        if node.open is not None:
            made.set_expanded(node.open)
        if not node.enabled:
            made.set_disabled()
        if node.live:
            made.set_live(accesskit.Live.POLITE)
        if node.rect is not None:
            made.set_bounds(accesskit.Rect(*map(float, node.rect)))
        if node.children:
            made.set_children([self._id(name) for name in node.children])
        for action in node.does:
            made.add_action(getattr(accesskit.Action, action))
        return made

    def _do(self, request: Any) -> None:
        """What a reader asks for, if the node is still there and can do it."""
        name = next((name for name, own in self._ids.items() if own == request.target), "")
        node = self._nodes.get(name)
        if node is None or not node.enabled:
            return
        for action, do in node.does.items():
            if request.action == getattr(accesskit.Action, action):
                do(None if request.data is None else request.data[1])
                self.parts.stage.redraw(True)
