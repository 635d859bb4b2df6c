"""What observes a session and never changes it: window, video, table."""
