"""How things look and sound, in the panel: what else there are keys for."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.draw.widgets.controls import Button, Choice, Control, Option, Switch
from sandbox.window.display import SCALES, is_fullscreen
from sandbox.window.keys import Action
from sandbox.window.sections import StageSection, Value
from sandbox.words import language, words


class LooksSection(StageSection):
    """Force chains, theme, size of text, language, sound, motion."""

    name = "looks"

    def controls(self) -> Sequence[Control]:
        """Switches and choices."""
        renderer = self.stage.renderer
        themes = tuple(Option(name, words.THEMES[name]) for name in ("dark", "light"))
        sizes = tuple(
            Option(size, size.replace(".", words.decimal_sign()) + " ×")
            for size in (f"{scale:g}" for scale in SCALES)
        )
        spoken = tuple(
            Option(code, str(language.table(code)["name"])) for code in language.available()
        )
        chains = renderer.chains or renderer.view.only_chains
        return [
            Switch("looks/chains", words.LOOK_CHAINS, chains, help=words.LOOK_CHAINS_HELP),
            Choice("looks/theme", words.LOOK_THEME, themes, renderer.theme.name),
            Choice("looks/size", words.LOOK_SIZE, sizes, f"{renderer.scale:g}"),
            Switch(
                "looks/fullscreen",
                words.LOOK_FULLSCREEN,
                is_fullscreen(),
                help=words.LOOK_FULLSCREEN_HELP,
            ),
            Choice("looks/language", words.LOOK_LANGUAGE, spoken, language.present()),
            Switch(
                "looks/sound", words.LOOK_SOUND, self.stage.sound.on, help=words.LOOK_SOUND_HELP
            ),
            Switch("looks/tone", words.LOOK_TONE, self.stage.tone.on, help=words.LOOK_TONE_HELP),
            Switch(
                "looks/motion", words.LOOK_MOTION, self.stage.still, help=words.LOOK_MOTION_HELP
            ),
            Button("looks/picture", words.LOOK_PICTURE, help=words.LOOK_PICTURE_HELP),
        ]

    def use(self, name: str, value: Value, done: bool) -> None:
        """Change it."""
        del done
        match name.partition("/")[2]:
            case "fullscreen":
                self.actions.act(Action.FULLSCREEN)
            case "chains":
                self.actions.act(Action.CHAINS)
            case "sound":
                self.actions.act(Action.SOUND)
            case "tone":
                self.actions.act(Action.TONE)
            case "motion":
                self.stage.prefer(still=bool(value))
            case "picture":
                self.actions.act(Action.SCREENSHOT)
            case "theme":
                self.stage.renderer.set_theme(str(value))
            case "size":
                self.actions.rescale(float(str(value)))
            case "language":
                self.actions.speak(str(value))
