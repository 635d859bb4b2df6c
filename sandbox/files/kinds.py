"""What files of this program say that they are: to be written, and for a message where one of another kind was meant."""

from __future__ import annotations

SCENE = "auxetic-sandbox scene"
LOG = "auxetic-sandbox log"


def is_log(content: bytes) -> bool:
    """Is it meant to be the log of a run? Its first line says so."""
    first = content.removeprefix(b"\xef\xbb\xbf").split(b"\n", 1)[0]
    return first.startswith(b"{") and LOG.encode() in first
