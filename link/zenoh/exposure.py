"""What of a Zenoh session strangers can reach: endpoints beyond this machine that do not prove who is at the end."""

from collections.abc import Iterable, Sequence

from link.errors import UserError
from link.transports.device import is_this_machine

_ENCRYPTED = frozenset({"tls", "quic"})
_OF_THIS_MACHINE = frozenset({"unixsock-stream", "unixpipe", "serial", "vsock"})
_REMEDY = "use tls/ with --zenoh-config (docs/zenoh, companion keys), or say --insecure"


def exposed(endpoints: Iterable[str], *, is_mutual: bool = True) -> list[str]:
    """Return those of `endpoints` by which a stranger could speak.

    Args:
        endpoints: in Zenoh's form.
        is_mutual: whether TLS asks both ends for a certificate.
    """
    return [one for one in endpoints if not (_is_local(one) or (_is_encrypted(one) and is_mutual))]


def check_exposure(
    *,
    connect: Sequence[str],
    listen: Sequence[str],
    protocols: Sequence[str] | None,
    is_mutual: bool,
    scouts: bool,
) -> None:
    """Check that a session can only be reached from this machine, or by who has a certificate.

    Args:
        connect: endpoints to connect to, where a certificate always proves the other end.
        listen: endpoints to listen on.
        protocols: that the session speaks at all, None for every one.
        is_mutual: whether who connects by TLS is asked for a certificate.
        scouts: whether others are looked for by multicast, and connected with.

    Raises:
        UserError: there is such an endpoint.
    """
    for endpoint in exposed(connect):
        raise UserError(f"--connect {endpoint}: whoever is on that network could give orders; {_REMEDY}")
    for endpoint in exposed(listen, is_mutual=is_mutual):
        if _is_encrypted(endpoint):
            raise UserError(
                f"--listen {endpoint}: takes anybody; set transport/link/tls/enable_mtls, or say --insecure"
            )
        raise UserError(f"--listen {endpoint}: whoever is on that network could give orders; {_REMEDY}")
    if scouts and not _is_encrypted_only(protocols):
        raise UserError(f"--multicast-scouting: whoever is on that network could give orders; {_REMEDY}")


def openings_of(
    *,
    connect: Sequence[str],
    listen: Sequence[str],
    protocols: Sequence[str] | None,
    is_mutual: bool,
    scouts: bool,
    has_rules: bool,
) -> tuple[str, ...]:
    """Return by what strangers could take part, as `check_exposure` refuses it, and where no rule says who may do what.

    Args:
        connect: endpoints to connect to.
        listen: endpoints to listen on.
        protocols: that the session speaks at all, None for every one.
        is_mutual: whether who connects by TLS is asked for a certificate.
        scouts: whether others are looked for by multicast.
        has_rules: whether access control is on.
    """
    open_ends = [*exposed(connect), *exposed(listen, is_mutual=is_mutual)]
    found = [f"Zenoh on {endpoint} takes anybody" for endpoint in open_ends]
    if scouts and not _is_encrypted_only(protocols):
        found.append("Zenoh's multicast scouting meets anybody")
    remote = [endpoint for endpoint in listen if not _is_local(endpoint) and endpoint not in open_ends]
    found += [f"Zenoh on {endpoint} has no access control" for endpoint in remote if not has_rules]
    return tuple(found)


def _is_encrypted_only(protocols: Sequence[str] | None) -> bool:
    return bool(protocols) and set(protocols or ()) <= _ENCRYPTED | _OF_THIS_MACHINE


def _is_encrypted(endpoint: str) -> bool:
    return endpoint.partition("/")[0] in _ENCRYPTED


def _is_local(endpoint: str) -> bool:
    protocol, _, address = endpoint.partition("/")
    if protocol in _OF_THIS_MACHINE:
        return True
    host = address.partition("?")[0].partition("#")[0].rpartition(":")[0].strip("[]")
    return is_this_machine(host)
