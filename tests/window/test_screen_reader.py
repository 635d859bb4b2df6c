"""What a screen reader finds and can do: the real window, asked over a bus of its own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.window.bus import FOCUSED, PRESSED, SLIDER, At, Listener, needs_bus, private_bus
from tests.window.screen import Person, invisible_screen, needs_screen, play, wait_for

pytestmark = [pytest.mark.end_to_end, needs_screen, needs_bus]


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    with invisible_screen() as display, private_bus(tmp_path) as environment:
        person = Person(display, tmp_path)
        person.environment.update(environment)
        yield person


def test_controls_are_read_and_used_and_what_happens_is_said(person: Person) -> None:
    reader = Listener(person.environment["DBUS_SESSION_BUS_ADDRESS"])

    def find(name: str) -> At:
        found: list[At] = []

        def there() -> bool:
            found.extend(filter(None, [reader.named(name)]))
            return bool(found)

        wait_for(there, 180, name)
        return found[0]

    with reader.announcements(), play(person, "single_grain") as program:
        wait_for(person.find_window, 60, "the window")
        slider = find("grains/poisson_ratio")
        assert reader.get(slider, "Name") == "Poisson's ratio"
        assert reader.call(slider, "Accessible", "GetRole") == SLIDER
        ends = [reader.get(slider, f"{which}Value", "Value") for which in ("Minimum", "Maximum")]
        assert ends == [0.0, 0.99]
        reader.set_value(slider, 0.5)
        wait_for(lambda: reader.get(slider, "CurrentValue", "Value") == 0.5, 20, "the value")

        assert reader.call(slider, "Component", "GrabFocus") is True
        wait_for(lambda: reader.state(slider, FOCUSED), 20, "the keyboard")
        person.key("Right")
        wait_for(lambda: reader.get(slider, "CurrentValue", "Value") == 0.51, 20, "one step")

        reader.press(find("general/drive"))
        said: list[str] = []

        def heard() -> bool:
            said.extend(reader.heard())
            return "scripted drive on" in said

        wait_for(heard, 20, "what is said")

        brush = find("general/brush")  # which stays as it is put; the drive soon comes to its end
        assert not reader.state(brush, PRESSED)
        reader.press(brush)
        wait_for(lambda: reader.state(brush, PRESSED), 20, "the brush")

        reader.press(find("general/help"))
        find("help/close")
        assert reader.named("general/drive") is None  # the page lies over it
        program.kill()
    reader.close()
