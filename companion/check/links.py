"""The lines of the check on who can reach the links; pure."""

from collections.abc import Sequence

from companion.check.findings import Finding, Level, pass_line


def assess_links(open_to_strangers: Sequence[str]) -> list[Finding]:
    """Return a line for each link that is open to somebody without a key, or one that none is."""
    if not open_to_strangers:
        return [pass_line("links", "open to nobody without a key, or to this machine only")]
    advice = "use keys (companion keys, --zenoh-config, --signing-key), or a network on which nobody else is"
    reason = "whoever reaches it can end the landing, or fly the drone"
    return [
        Finding(name="links", level=Level.WARN, found=text, advice=advice, reason=reason) for text in open_to_strangers
    ]
