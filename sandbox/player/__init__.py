"""A finished run as one HTML file that plays it: no request, no dependency, and no physics, it draws only.

    tape = Tape()
    tape.add([session.frame()])         # after the start and each increment; several frames side by side
    html = page(tape)                   # sandbox.player.page.page(tape, Look(theme="light", language="de")) -> str

``sandbox.player.tape`` keeps what is needed of the frames, ``coding`` writes it down, ``page`` makes the file.
"""
