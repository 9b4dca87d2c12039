"""A private certificate authority and what it signs: who may meet whom over TLS, each by a certificate of its own.

Keys are on the curve P-256. Zenoh's access control goes by a certificate's common name. The authority's own key stays
on the computer on which it was made: whoever has it can make further certificates.
"""

import ipaddress
import os
import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from link.errors import UserError
from link.program.text import read_bounded

AUTHORITY = "ca"
_HOST_NAME = re.compile(r"[A-Za-z0-9_.*-]+")
_NOT_BEFORE = timedelta(days=1)  # a clock that is not yet set by GNSS or NTP may be behind


class Authority:
    """The private authority whose files stand in a folder; made there if it is not there yet.

    Args:
        folder: of `ca.pem` and `ca.key`, made when it is missing.
        days: for which what it signs is valid.

    Raises:
        UserError: the folder cannot be written, or what is there is no authority.
    """

    def __init__(self, folder: Path, days: int) -> None:
        self._folder = folder
        self._days = days
        certificate, key = folder / f"{AUTHORITY}.pem", folder / f"{AUTHORITY}.key"
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if certificate.exists() and key.exists():
                self._certificate = x509.load_pem_x509_certificate(read_bounded(certificate))
                self._key = _ec_key(read_bounded(key))
                return
        except OSError as error:
            raise UserError(f"{folder}: cannot be used ({error.strerror}); choose another folder") from error
        except (ValueError, TypeError) as error:
            raise UserError(f"{folder}: {AUTHORITY}.pem and {AUTHORITY}.key are no authority ({error})") from error
        self._key = ec.generate_private_key(ec.SECP256R1())
        self._certificate = self._signed("decklander authority", self._key.public_key(), (), is_authority=True)
        self._write(AUTHORITY, self._certificate, self._key)

    def issue(self, name: str, hosts: Sequence[str] = ()) -> None:
        """Write a certificate with the common name `name` and its key, for an end of a connection.

        Args:
            name: also of the files.
            hosts: names and addresses at which others reach it, for one that listens.

        Raises:
            UserError: they exist already, or cannot be written.
        """
        key = ec.generate_private_key(ec.SECP256R1())
        self._write(name, self._signed(name, key.public_key(), hosts, is_authority=False), key)

    def _signed(
        self, name: str, public_key: ec.EllipticCurvePublicKey, hosts: Sequence[str], *, is_authority: bool
    ) -> x509.Certificate:
        now = datetime.now(UTC)
        subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
        builder = (
            x509.CertificateBuilder()
            .subject_name(subject)
            .issuer_name(subject if is_authority else self._certificate.subject)
            .public_key(public_key)
            .serial_number(x509.random_serial_number())
            .not_valid_before(now - _NOT_BEFORE)
            .not_valid_after(now + timedelta(days=self._days))
            .add_extension(
                x509.BasicConstraints(ca=is_authority, path_length=0 if is_authority else None), critical=True
            )
        )
        if not is_authority:
            both = [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]
            names = x509.SubjectAlternativeName([_general_name(host) for host in (name, *hosts)])
            builder = builder.add_extension(x509.ExtendedKeyUsage(both), critical=False)
            builder = builder.add_extension(names, critical=False)
        return builder.sign(self._key, hashes.SHA256())

    def _write(self, name: str, certificate: x509.Certificate, key: ec.EllipticCurvePrivateKey) -> None:
        encoding = serialization.Encoding.PEM
        plain = key.private_bytes(encoding, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
        write_secret(self._folder / f"{name}.key", plain)
        write_secret(self._folder / f"{name}.pem", certificate.public_bytes(encoding))


def write_secret(path: Path, content: bytes) -> None:
    """Write a new file that only its owner may read.

    Raises:
        UserError: it exists, or cannot be written.
    """
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        raise UserError(f"{path}: exists, and somebody may use it; delete it, or choose another folder") from None
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another folder") from error
    with open(descriptor, "wb") as file:  # noqa: PTH123 (a descriptor, whose mode is right from its beginning)
        file.write(content)


def _ec_key(pem: bytes) -> ec.EllipticCurvePrivateKey:
    key = serialization.load_pem_private_key(pem, password=None)
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise TypeError("the key is on no elliptic curve")
    return key


def check_host(option: str, host: str) -> None:
    """Find out whether a certificate can be for `host`, before any is made.

    Raises:
        UserError: it cannot, which names the option.
    """
    try:
        _general_name(host)
    except ValueError:
        raise UserError(
            f"{option} {host!r} is no name or address of a host: write one such as drone.local or 192.168.4.1"
        ) from None


def _general_name(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        pass
    if _HOST_NAME.fullmatch(host) is None:
        raise ValueError(f"{host!r} is no name of a host")
    return x509.DNSName(host)
