"""A bus that nobody else is on, and who asks there what a screen reader asks: names, roles, values, and what is said.

Programs of Debian's make the bus: dbus and at-spi2-core. Roles and states are numbers of AT-SPI's.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

try:
    import accesskit
    from jeepney import DBusAddress, MatchRule, Properties, message_bus, new_method_call
    from jeepney.io.blocking import Proxy, open_dbus_connection
except ImportError:
    accesskit = None

LAUNCHER = Path("/usr/libexec/at-spi-bus-launcher")
needs_bus = pytest.mark.skipif(
    accesskit is None or shutil.which("dbus-daemon") is None or not LAUNCHER.exists(),
    reason="needs accesskit and jeepney, dbus-daemon and at-spi2-core",
)
ATSPI = "org.a11y.atspi."
TOGGLE, SLIDER, PUSH, RADIO = 62, 51, 43, 44  # roles
FOCUSED, PRESSED = 12, 20  # states
PATIENCE = 10  # with an answer [s]

At = tuple[str, str]  # a node: whose, and its path


@contextmanager
def private_bus(folder: Path) -> Iterator[dict[str, str]]:
    """What leads a program to it."""
    runtime = folder / "run"
    runtime.mkdir(mode=0o700)
    own = {f"XDG_{kind}_HOME": str(folder / kind.lower()) for kind in ("CONFIG", "DATA")}
    own |= {"HOME": str(folder), "XDG_RUNTIME_DIR": str(runtime)}
    own["XDG_CACHE_HOME"] = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))  # kernels
    environment = {**os.environ, **own}
    environment.pop("DBUS_SESSION_BUS_ADDRESS", None)
    daemon = subprocess.Popen(
        ["dbus-daemon", "--session", "--nofork", "--print-address=1"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert daemon.stdout is not None
    try:
        yield {**own, "DBUS_SESSION_BUS_ADDRESS": daemon.stdout.readline().strip()}
    finally:
        daemon.terminate()
        daemon.wait(PATIENCE)
        daemon.stdout.close()


class Listener:
    """Part of a screen reader."""

    def __init__(self, session: str) -> None:
        self.session = session
        self.latest: list[str] = []  # names of the nodes that were found as one was last looked for
        with open_dbus_connection(session) as bus:
            launcher = DBusAddress("/org/a11y/bus", "org.a11y.Bus", "org.a11y.Status")
            bus.send_and_get_reply(
                Properties(launcher).set("IsEnabled", "b", True), timeout=PATIENCE
            )
            ask = new_method_call(launcher.with_interface("org.a11y.Bus"), "GetAddress")
            address = bus.send_and_get_reply(ask, timeout=PATIENCE).body[0]
        self.address = address.partition(",")[0]
        self.bus = open_dbus_connection(self.address)

    def close(self) -> None:
        self.bus.close()

    def call(self, node: At, interface: str, method: str, *arguments: Any) -> Any:
        """A method's answer; None where the node has no such."""
        signature, *values = arguments or ("",)
        address = DBusAddress(node[1], node[0], ATSPI + interface)
        message = new_method_call(address, method, signature or None, tuple(values))
        reply = self.bus.send_and_get_reply(message, timeout=PATIENCE)
        return reply.body[0] if reply.body and reply.header.message_type.name != "error" else None

    def get(self, node: At, name: str, interface: str = "Accessible") -> Any:
        message = Properties(DBusAddress(node[1], node[0], ATSPI + interface)).get(name)
        reply = self.bus.send_and_get_reply(message, timeout=PATIENCE)
        return reply.body[0][1] if reply.header.message_type.name != "error" else None

    def set_value(self, node: At, value: float) -> None:
        where = DBusAddress(node[1], node[0], ATSPI + "Value")
        message = Properties(where).set("CurrentValue", "d", value)
        self.bus.send_and_get_reply(message, timeout=PATIENCE)

    def press(self, node: At) -> None:
        assert self.call(node, "Action", "DoAction", "i", 0) is True

    def all(self, node: At | None = None) -> Iterator[At]:
        """Every node, from the top."""
        node = node or (ATSPI + "Registry", "/org/a11y/atspi/accessible/root")
        for child in self.call(node, "Accessible", "GetChildren") or ():
            yield child
            yield from self.all(child)

    def named(self, name: str) -> At | None:
        """The node that the window calls so; None while there is none, or while a window that begins leaves a question open."""
        self.latest = []
        try:
            for node in self.all():
                self.latest.append(str(self.get(node, "AccessibleId")))
                if self.latest[-1] == name:
                    return node
        except TimeoutError:
            self.latest.append("no answer")
        return None

    def state(self, node: At, number: int) -> bool:
        low, high = self.call(node, "Accessible", "GetState")
        return bool((low | high << 32) >> number & 1)

    @contextmanager
    def announcements(self) -> Iterator[list[str]]:
        """What is said meanwhile; read off by ``heard``."""
        connection = open_dbus_connection(self.address)
        rule = MatchRule(type="signal", interface=ATSPI + "Event.Object", member="Announcement")
        Proxy(message_bus, connection).AddMatch(rule)
        with connection, connection.filter(rule) as self._said:
            self._connection = connection
            yield []

    def heard(self, seconds: float = 0.3) -> list[str]:
        """Announcements that have come since the last call."""
        texts = []
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            try:
                message = self._connection.recv_until_filtered(self._said, timeout=0.1)
            except TimeoutError:
                continue
            texts.append(str(message.body[3][1]))
        return texts
