"""What is set up, and how it is driven. A scene knows no window, no drawing and no file: see ``scene`` and ``registry``."""
