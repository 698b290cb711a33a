"""The errors a user may cause; the command line prints them as one line and exits with 2."""


class UserError(Exception):
    """Something the user can put right; the message is one line that says what and how."""


class InputError(UserError, ValueError):
    """A wrong argument, file or setting: the message names it and says what is accepted."""


class UnavailableError(UserError, RuntimeError):
    """Something this machine lacks: the message says how to install it."""
