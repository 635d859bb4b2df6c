"""From a Frame to pixels: pure functions of data, with no window and no solver."""
