"""The window: what a person sees and does. ``app`` puts its parts together; the solver works in threads of its own."""
