"""What a user did that the program can name: one clear line, exit status 2."""


class InputError(ValueError):
    """Bad input or bad usage: the message names the file or option, what was found and what is allowed."""
