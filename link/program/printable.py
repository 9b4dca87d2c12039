"""Texts of others as they may be shown: what a terminal would take for an order is replaced."""


def printable(text: str) -> str:
    """Return `text` with the code in place of each character that is neither visible nor a space."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else ascii(one)[1:-1] for one in text)
