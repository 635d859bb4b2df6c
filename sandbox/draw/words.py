"""Every word that is drawn, in one place: short, plain, sentence case."""

from __future__ import annotations

KINDS = {"regular": "regular: bulges", "auxetic": "auxetic: shrinks"}
KINDS_SHORT = {"regular": "regular", "auxetic": "auxetic"}

# Ways to look at the grains: the names for the command line, and what the legend says.
VIEWS = {
    "kind": "kinds",
    "skin": "as made",
    "pressure": "pressure",
    "shape": "shape change (a − b)/(a + b)",
    "area": "area lost",
    "motion": "motion against the mean",
    "chains": "force chains",
    "fringes": "stress fringes",
}

VIEW = "view: {view}"

SETTLED = "settled"
SETTLING = "settling"
STOPPED = {
    "converged": SETTLED,
    "budget": "time used up, not settled",
    "iteration limit": "iteration limit, not settled",
    "not finite": "numbers went bad: press R to reset",
    "collapsed": "a grain was crushed flat: press R to reset",
}
BROKEN = frozenset({"not finite", "collapsed"})
FORCE_ERROR = "forces balance within {error}"
NO_FORCES = "no forces"
UNKNOWN_FORCES = "forces not known yet"

SEED = "seed {seed}"
INCREMENT = "increment {increment}"
RATE = "{fps:.0f} frames/s · {ms:.0f} ms"
RATE_SLOW = "{fps:.0f} frames/s · {reason}"
SLOW_DRAWING = "drawing takes {ms:.0f} ms"
SLOW_MACHINE = "the computer is busy"
PAUSED = "paused"
DRIVE = "scripted drive"
GRAINS_OUT = "{count} out"

CHAINS = "force chains"
FORCE_UNIT = "k R"
STRESS_UNIT = "k"
LENGTH_UNIT = "R"
PERCENT = "%"
STROKE_AXIS = "stroke [R]"
NO_CURVE = "nothing has moved yet"

HINT = "Drag the orange handle · A lets it move by itself · H shows all keys"

SPLASH_TITLE = "Auxetic sandbox"
SPLASH_STEP = "preparing"
SPLASH_ABOUT = "Squeezed grains: regular ones bulge, auxetic ones shrink."
BUILDING = "{text} · {percent:.0f} %"

MENU_TITLE = "Choose a scene"
MENU_KEYS = "Arrow keys and Enter, or click   ·   1 2 3 packing   ·   T theme   ·   Esc quit"

ERROR_TITLE = "This run has stopped"
ERROR_ADVICE = "R: start this scene again · M: scene menu · Esc: quit"

HELP_TITLE = "Keys"
HELP = (
    ("Mouse", "drag a handle"),
    ("Space", "pause"),
    ("S, →", "one increment"),
    ("R", "reset"),
    ("1  2  3", "packing"),
    ("P", "next packing"),
    ("N", "new seed"),
    ("A", "scripted drive"),
    ("V", "next view"),
    ("F", "force chains"),
    ("M, Tab", "scene menu"),
    ("T", "dark or light"),
    ("+  −", "text size"),
    ("F12", "screenshot"),
    ("H, F1", "this page"),
    ("Esc", "back, then quit"),
)

SAVED = "saved {name}"
NOT_SAVED = "could not save {name}: {reason}"
NEW_SEED = "new seed: {seed}"
NEW_PACKING = "{packing} grains"
ONLY_CHAINS = "this view is the force chains"
CHAINS_ON = "force chains on"
CHAINS_OFF = "force chains off"
DRIVE_ON = "scripted drive on"
DRIVE_OFF = "scripted drive off: the hand is yours"
PACKINGS = {"regular": "regular", "auxetic": "auxetic", "mixed": "mixed"}
