"""The Zenoh library's own session: its configuration from ours, and its failures as one line each."""

import json
import re
from itertools import accumulate
from pathlib import Path
from typing import TypedDict

import zenoh

from link.errors import UserError
from link.program.text import read_bounded, read_text
from link.zenoh.exposure import check_exposure, openings_of
from link.zenoh.options import DEFAULT_ENDPOINT, ZenohOptions
from link.zenoh.unmet import TlsFiles, why_unmet

_SOURCE_PLACE = re.compile(r"\s+at /\S+\.rs:\d+\.?")
_CLIENT_CONNECT_TIMEOUT_MS = 5000
_BLOCK_MAX_KEY = "transport/link/tx/queue/congestion_control/block/wait_before_close"
_BLOCK_MAX_US = 200_000
"""A peer that takes nothing for this long while its queue is full is disconnected: a hung dashboard must not
stall the loop that flies. Less than the half second after which autopilots call a setpoint stream lost."""

_TLS = "transport/link/tls/"
_WAYS, _ENCRYPTED = ("listen", "connect"), ("tls/", "quic/", "wss/")
_TLS_FILES = ("root_ca_certificate", *(f"{way}_{file}" for way in _WAYS for file in ("private_key", "certificate")))
_SHOWN = ("connect_certificate", "connect_private_key")
_JSON5_PLACE = re.compile(r"-->\s*(\d+):(\d+)")

_BRACKETS_MAX = 100
"""Zenoh's own configuration has seven; deep ones end its parser, and with it the program, without a word."""

_MESSAGE_MAX_KEY = "transport/link/rx/max_message_size"


def open_library_session(options: ZenohOptions, *, stamps: bool = False) -> zenoh.Session:
    """Return the library's own session, for other layouts; see `open_session`.

    Args:
        options: how to meet others.
        stamps: put Zenoh's own time stamps on samples, which those that are kept for who comes later need.
    """
    config = _config(options)
    if stamps:
        _insert(config, "timestamping/enabled", True)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise UserError(_open_failure(options, config, str(error))) from error


def is_matched(entity: object) -> bool:
    """Return whether anybody is there for a publisher or a querier of the library; True where it cannot tell."""
    status: object = getattr(entity, "matching_status", True)  # its stub calls it a plain truth value
    return bool(getattr(status, "matching", status))


def _config(options: ZenohOptions) -> zenoh.Config:
    config = zenoh.Config() if options.config_file is None else _config_from_file(options.config_file)
    if options.mode is not None:
        _insert(config, "mode", options.mode)
    if options.connect:
        _insert(config, "connect/endpoints", list(options.connect))
    if options.multicast_scouting is not None:
        _insert(config, "scouting/multicast/enabled", options.multicast_scouting)
    _fill(config, "mode", "peer")
    _fill(config, "scouting/multicast/enabled", False)
    _fill_connection(config)
    if options.listen:
        _insert(config, "listen/endpoints", list(options.listen))
    elif _get(config, "listen/endpoints") == _get(zenoh.Config(), "listen/endpoints"):
        # Zenoh's own default is plain TCP on all interfaces, beside whatever a file says of TLS.
        own = [] if options.config_file or _get(config, "mode") == "client" else ["tcp/127.0.0.1:0"]
        _insert(config, "listen/endpoints", own)
    _check_tls_files(config, options.config_file)
    if not options.insecure:
        check_exposure(**_exposure(config))
    if _get(config, "mode") != "router" and _get(config, _MESSAGE_MAX_KEY) == _get(zenoh.Config(), _MESSAGE_MAX_KEY):
        _insert(config, _MESSAGE_MAX_KEY, options.message_max_bytes)
    if _get(config, _BLOCK_MAX_KEY) == _get(zenoh.Config(), _BLOCK_MAX_KEY):
        _insert(config, _BLOCK_MAX_KEY, _BLOCK_MAX_US)
    return config


def openings(options: ZenohOptions) -> tuple[str, ...]:
    """Return by what strangers could take part in a session of these options, in words.

    Raises:
        UserError: If the configuration file is missing or wrong.
    """
    config = _config(options)
    return openings_of(**_exposure(config), has_rules=_get(config, "access_control/enabled") is True)


class _Exposure(TypedDict):
    connect: list[str]
    listen: list[str]
    protocols: list[str] | None
    is_mutual: bool
    scouts: bool


def _exposure(config: zenoh.Config) -> _Exposure:
    protocols = _get(config, "transport/link/protocols")
    return _Exposure(
        connect=_endpoints(config, "connect/endpoints"),
        listen=_endpoints(config, "listen/endpoints"),
        protocols=protocols if isinstance(protocols, list) else None,
        is_mutual=_get(config, "transport/link/tls/enable_mtls") is True,
        scouts=_get(config, "scouting/multicast/enabled") is True,
    )


def _endpoints(config: zenoh.Config, key: str) -> list[str]:
    """Return endpoints of all modes: those of the session's own, or a table with a list for each mode."""
    found = _get(config, key)
    lists = found.values() if isinstance(found, dict) else (found,)
    return [str(endpoint) for one in lists for endpoint in (one if isinstance(one, list) else ())]


def _fill_connection(config: zenoh.Config) -> None:
    """Make peers and routers connect for ever in the background, and clients, whose opening waits, give up."""
    is_client = _get(config, "mode") == "client"
    if is_client and not _get(config, "connect/endpoints") and not _get(config, "scouting/multicast/enabled"):
        raise UserError(f"--mode client needs a router to connect to: add --connect {DEFAULT_ENDPOINT}")
    _fill(config, "connect/timeout_ms", _CLIENT_CONNECT_TIMEOUT_MS if is_client else -1)
    _fill(config, "connect/exit_on_failure", is_client)


def _config_from_file(path: Path) -> zenoh.Config:
    try:
        text = read_text(path)
    except UserError as error:
        raise UserError(f"--zenoh-config {error}") from None
    if _brackets_deep(text) > _BRACKETS_MAX:
        raise UserError(f"--zenoh-config {path}: nested too deep; no setting of Zenoh's is")
    try:
        return zenoh.Config.from_json5(text)
    except zenoh.ZError as error:
        place = _JSON5_PLACE.search(str(error))
        if place is None:
            raise UserError(f"--zenoh-config {path}: {_plain(str(error))}") from error
        where = f"from line {place[1]}, column {place[2]} on"
        raise UserError(f"--zenoh-config {path}: no valid JSON5 {where}; check commas, colons and brackets") from error


def _brackets_deep(text: str) -> int:
    """Return how deep the brackets of a text are, those in its comments counted as well."""
    steps = ((one in "{[") - (one in "}]") for one in text)
    return max(accumulate(steps), default=0)


def _check_tls_files(config: zenoh.Config, config_file: Path | None) -> None:
    """Read the files of keys and certificates: of one that it cannot read, Zenoh says that nobody answers."""
    ways = {way: any(one.startswith(_ENCRYPTED) for one in _endpoints(config, f"{way}/endpoints")) for way in _WAYS}
    for name in _TLS_FILES:
        path, way = _get(config, _TLS + name), name.partition("_")[0]
        if not isinstance(path, str) or not path or not ways.get(way, any(ways.values())):
            continue
        try:
            read_bounded(Path(path))
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise UserError(
                f"--zenoh-config {config_file}: {name}: {path} cannot be read ({why}); name the file that "
                "there is, and let the user that runs the program read it"
            ) from error


def _get(config: zenoh.Config, key: str) -> object:
    return json.loads(config.get_json(key))


def _insert(config: zenoh.Config, key: str, value: object) -> None:
    config.insert_json5(key, json.dumps(value))


def _fill(config: zenoh.Config, key: str, value: object) -> None:
    """Set what the configuration file leaves open."""
    if _get(config, key) is None:
        _insert(config, key, value)


def _open_failure(options: ZenohOptions, config: zenoh.Config, text: str) -> str:
    endpoints = ", ".join(options.listen) or f"the endpoints of {options.config_file}"
    if "Address already in use" in text:
        return f"--listen {endpoints}: the port is in use, stop the other program or choose another port"
    if _get(config, "mode") == "client":
        return _unmet(config, text)
    return f"cannot open the Zenoh session (--listen {endpoints}): {_plain(text)}"


def _unmet(config: zenoh.Config, text: str) -> str:
    to = _endpoints(config, "connect/endpoints")
    own = {name: _get(config, _TLS + name) for name in ("root_ca_certificate", *_SHOWN)}
    authority, certificate, key = (str(one) if one else None for one in own.values())
    verifies_name = _get(config, f"{_TLS}verify_name_on_connect") is not False
    files = TlsFiles(authority=authority, certificate=certificate, key=key, verifies_name=verifies_name)
    seen = [f"{endpoint}: {why}" for endpoint in to if (why := why_unmet(endpoint, files)) is not None]
    if seen:
        return f"--connect {'; '.join(seen)}"
    return f"--connect {', '.join(to)}: no router answers there ({_plain(text)})"


def _plain(text: str) -> str:
    """Return a message of the library on one line, without the places in its source code."""
    return " ".join(_SOURCE_PLACE.sub("", text).split())
