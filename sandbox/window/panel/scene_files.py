"""What a person has made as a scene file: saved under a name, opened from the current folder."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from core.errors import InputError
from sandbox.draw.widgets.controls import Button, Control, Note, Row, TextField
from sandbox.files.scene_file import SUFFIXES, scenes_here
from sandbox.window.actions import Actions
from sandbox.window.sections import StageSection, Value
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes.text import message

STALE = 3.0  # the folder is looked at again after this [s]
OPEN = "files/open/"


class FilesSection(StageSection):
    """A name, a button to save, and the files of the folder to open."""

    name = "files"

    def __init__(self, stage: Stage, actions: Actions) -> None:
        super().__init__(stage, actions)
        self.stem = ""  # typed; empty: after the scene
        self._found: tuple[Path, ...] = ()
        self._looked = -STALE

    def controls(self) -> Sequence[Control]:
        """Save, then open."""
        field = TextField("files/name", words.FILE_NAME, self._stem(), help=words.FILE_NAME_HELP)
        save = Button("files/save", words.FILE_SAVE, help=words.FILE_SAVE_HELP)
        files = self._files()
        return [
            Row((field, save), (2.0, 1.2)),
            Note(words.FILES_HERE if files else words.NO_FILES),
            *(Button(OPEN + path.name, path.stem, help=words.FILE_OPEN_HELP) for path in files),
        ]

    def use(self, name: str, value: Value, done: bool) -> None:
        """Save, or open."""
        del done
        if name == "files/name":
            name = Path(str(value).strip()).name
            self.stem = next((name[: -len(s)] for s in SUFFIXES if name.endswith(s)), name)
        elif name == "files/save":
            self.actions.save(self._stem())
            self._looked = -STALE
        else:
            self._open(name.removeprefix(OPEN))

    def _open(self, name: str) -> None:
        for path in self._found:
            if path.name == name:
                try:
                    self.stage.open(path)
                except InputError as error:
                    self.stage.toast(words.say(message(error)))

    def _stem(self) -> str:
        return self.stem or f"my-{self.stage.panes.scene.replace('_', '-')}"

    def _files(self) -> Sequence[Path]:
        """The scene files in the current folder, the newest first."""
        now = time.perf_counter()
        if now - self._looked >= STALE:
            self._looked = now
            self._found = tuple(found.path for found in scenes_here(Path()))
        return self._found
