"""A lesson with a choice, a number and a sketch, for tests of the window."""

from __future__ import annotations

from sandbox.lessons.reading import parse_lesson
from tests.window.desk import Desk

LESSON = """
format = "auxetic-sandbox lesson"
version = 1
scene = "intruder"
title = "A lesson"
hide = ["packing", "seed", "friction", "files"]
[[step]]
key = "pick"
packings = ["mixed"]
say = "Look."
do = "Drag."
until = { moved = "intruder", by = 2.0 }
[step.predict]
kind = "choice"
ask = "Which?"
options = ["this", "that"]
right = 2
answer = "That, as everybody knows."
[[step]]
key = "guess"
say = "Once more."
[step.predict]
kind = "number"
ask = "How much?"
right = 3
within = 0.5
unit = "k R"
[[step]]
key = "draw"
say = "Look."
do = "Drag."
until = { increments = 2 }
hide = ["solver"]
[step.predict]
kind = "sketch"
ask = "How does it go on?"
along = [0, 30]
up = [0, 4]
"""


def begin(desk: Desk) -> None:
    """It is begun; its first scene may not be there yet."""
    desk.app.guide.begin(parse_lesson("mine", LESSON.encode(), ""))


def ready(desk: Desk) -> None:
    """Until all of the scene is there."""
    run = desk.app.stage.panes
    desk.until(lambda: not desk.app._splash and all(s.phase == "running" for s in run.snapshots))
    desk.app.tick()
