"""Does the person at this computer wish for little motion? Where the system has a switch for that, it is asked."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
from functools import cache

PATIENCE = 1.0  # with a program that tells [s]
_CLIENT_AREA_ANIMATION = 0x1042  # of Windows: SPI_GETCLIENTAREAANIMATION

# The program that tells, and what it says where little motion is wished for.
_MAC = ("defaults", "read", "com.apple.universalaccess", "reduceMotion"), "1"
_GNOME = ("gsettings", "get", "org.gnome.desktop.interface", "enable-animations"), "false"


@cache
def little_motion_wished() -> bool:
    """As the system has it; no, where it does not tell. It is asked once."""
    if sys.platform == "win32":
        on = ctypes.c_int(1)
        ctypes.windll.user32.SystemParametersInfoW(_CLIENT_AREA_ANIMATION, 0, ctypes.byref(on), 0)
        return not on.value
    command, wished = _MAC if sys.platform == "darwin" else _GNOME
    if shutil.which(command[0]) is None:
        return False
    try:
        told = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return told.stdout.strip() == wished
