"""Which hosts are this machine."""

import ipaddress


def is_this_machine(host: str) -> bool:
    """Return whether `host`, a name or an address without brackets, is loopback."""
    try:
        return ipaddress.ip_address(host.partition("%")[0]).is_loopback
    except ValueError:
        return host == "localhost"
