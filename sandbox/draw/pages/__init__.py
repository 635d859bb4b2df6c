"""Pages that cover the window: menu, help, splash, cards."""
