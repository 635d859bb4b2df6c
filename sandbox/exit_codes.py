"""What a command tells the shell when it ends."""

OK = 0
DIFFERENT = 1  # a replay came out otherwise than its log says
USER_MISTAKE = 2
INTERRUPTED = 130  # as shells count: 128 + SIGINT
