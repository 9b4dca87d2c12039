"""The one exception that stands for a mistake the user can mend."""


class UserError(Exception):
    """A wrong file, device, name or value.

    Its text is one line that says what is wrong and what to change; programs print it and exit with code 2.
    """
