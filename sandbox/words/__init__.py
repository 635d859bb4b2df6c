"""Every word that is shown, one file a language."""
