"""What a command tells the shell when it ends."""

OK = 0
DIFFERENT = 1  # a replay came out otherwise than its log says
CHECK_FAILED = 1  # what a scene says must hold at the end of its run does not
FAILED = 1  # a study could not carry out all that it was asked
USER_MISTAKE = 2
INTERRUPTED = 130  # as shells count: 128 + SIGINT
