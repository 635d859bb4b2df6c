"""From kernels to one WebAssembly file, when pages are built; see ``target`` and ``linking``. The program itself never imports this."""
