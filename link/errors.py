"""The one exception that stands for a mistake the user can mend, and its words."""


class UserError(Exception):
    """A wrong file, device, name or value.

    Its text is one line that says what is wrong and what to change; programs print it and exit with code 2.
    """


def own_words(message: str) -> str:
    """Return what a check of one's own says, without what pydantic puts before it."""
    return message.replace("Value error, ", "")
