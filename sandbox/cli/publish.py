"""The commands ``site`` and ``web``: pages for a browser. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
import sys

from sandbox.cli.exit_codes import INTERRUPTED, OK
from scenes.text import counted


def site(options: argparse.Namespace) -> int:
    """Write the gallery."""
    from sandbox.files.folder import prepare_folder
    from sandbox.site import site as gallery
    from sandbox.site import studies as results
    from scenes import registry

    scenes = [registry.get(name).name for name in options.scene or registry.names()]
    results.require_markdown()
    folder = prepare_folder(options.out, "")
    try:
        written = gallery.site(folder, list(dict.fromkeys(scenes)), options.steps)
    except KeyboardInterrupt:
        print(f"stopped; the pages in {folder} that are there are whole", file=sys.stderr)
        return INTERRUPTED
    size = sum(path.stat().st_size for path in written)
    print(f"{counted(len(written), 'page')}, {size / 1e6:.1f} MB: {folder / 'index.html'}")
    if not results.found():
        print("without what was measured: this installation has no assets/studies")
    if size > gallery.MOST:
        print(
            f"larger than {gallery.MOST / 1e6:g} MB: use --scene or --steps for a smaller gallery"
        )
    return OK


def web(options: argparse.Namespace) -> int:
    """Write pages on which scenes run."""
    from sandbox import environment
    from sandbox.ensemble.pool import Pool
    from sandbox.files.folder import prepare_folder
    from sandbox.web.toolchain import require_tools

    environment.hide_greeting()
    require_tools()
    from sandbox.web import building

    asked = [options.single] if options.single else options.scene or building.SCENES
    names = [building.scene_named(name) for name in dict.fromkeys(asked)]
    folder = prepare_folder(options.out, "")
    single = options.single is not None

    try:
        with Pool(building.JOBS) as pool:
            written = building.write(
                folder,
                names,
                pool,
                lambda text: print(text, flush=True),
                seeds=options.seeds,
                single=single,
            )
    except KeyboardInterrupt:
        print(f"stopped; the pages in {folder} that are there are whole", file=sys.stderr)
        return INTERRUPTED
    for path in written:
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")
    return OK
