"""Why no session comes about with whoever listens at an endpoint: of whatever is wrong Zenoh says that it timed out."""

import socket
import ssl

from msgspec import Struct

_WAIT_S = 2.0
_ALERT = "ALERT_"


class TlsFiles(Struct, frozen=True, kw_only=True):
    """What a session that connects shows and believes; None where its configuration names no file.

    Attributes:
        authority: whose certificates are believed.
        certificate: that is shown.
        key: of that certificate.
        verifies_name: whether the certificate of the other side has to name its host.
    """

    authority: str | None
    certificate: str | None
    key: str | None
    verifies_name: bool


def why_unmet(endpoint: str, files: TlsFiles) -> str | None:
    """Return what is seen to be wrong, None where nobody listens there or nothing is."""
    protocol, _, place = endpoint.partition("/")
    host, _, port = place.rpartition(":")
    if protocol not in {"tcp", "tls"} or not port.isdecimal():
        return None
    try:
        with socket.create_connection((host.strip("[]"), int(port)), timeout=_WAIT_S) as connection:
            return "it is reached, but not met as tcp/: tls/?" if protocol == "tcp" else _greet(connection, host, files)
    except OSError:
        return None


def _greet(connection: socket.socket, host: str, files: TlsFiles) -> str | None:
    """Return why a handshake fails; the other side refuses a certificate only after it, in place of its first byte."""
    try:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.check_hostname = files.verifies_name
        if files.authority is not None:
            context.load_verify_locations(files.authority)
        if files.certificate is not None:
            context.load_cert_chain(files.certificate, files.key)
    except ssl.SSLError as error:
        return f"certificate and key cannot be used ({_words(error)}): take both from one `companion keys`"
    try:
        greeted = context.wrap_socket(connection, server_hostname=host.strip("[]"))
    except ssl.SSLCertVerificationError as error:
        return (
            f"its certificate is refused ({error.verify_message}): see ca.pem, `companion keys --host`, the date here"
        )
    except OSError:
        return "it is reached, but not met as tls/: tcp/?"
    try:
        with greeted:
            greeted.recv(1)
    except ssl.SSLError as error:
        return f"it refuses this certificate ({_words(error)}): take one from the same `companion keys`; see its date"
    return None


def _words(error: ssl.SSLError) -> str:
    return str(error.reason or error).rpartition(_ALERT)[2].replace("_", " ").lower()
