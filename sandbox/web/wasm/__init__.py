"""From kernels to one WebAssembly file, when pages are built; see ``target`` and ``linking``. Nothing else imports this."""
