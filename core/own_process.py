"""Whether this process is the program's own, or one in which others work too: a notebook, somebody's script."""

from __future__ import annotations

from threading import Event

OWN = Event()  # set where a process begins and ends with the program
