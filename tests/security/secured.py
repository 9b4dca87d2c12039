"""The shipped Zenoh files with the certificates of `companion keys`, made to meet on a free port of this machine."""

from dataclasses import dataclass
from pathlib import Path

from companion.runtime.keys import keys
from link.zenoh.certificates import Authority
from scenarios.processes.programs import free_tcp_endpoint

SHIPPED = Path(__file__).parents[2] / "docs" / "zenoh"
STRANGER = "stranger"
"""Has a certificate of the right authority, by a name that no rule knows."""


@dataclass(frozen=True, slots=True)
class Secured:
    """The files in a folder, for an endpoint on loopback."""

    folder: Path
    endpoint: str

    def file(self, name: str, certificate: str | None = None, authority: Path | None = None) -> Path:
        """Return the shipped file `name`, perhaps with a certificate of another name, or by another authority."""
        text = (SHIPPED / f"{name}.json5").read_text(encoding="utf-8")
        for address in ("tls/0.0.0.0:7447", "tls/VEHICLE:7447"):
            text = text.replace(address, self.endpoint)
        own = certificate or name
        text = text.replace(f"/{name}.pem", f"/{own}.pem").replace(f"/{name}.key", f"/{own}.key")
        path = self.folder / f"{name}_{own}_{'ours' if authority is None else 'other'}.json5"
        path.write_text(text.replace("/etc/decklander", str(authority or self.folder)), encoding="utf-8")
        return path


def secured(folder: Path) -> Secured:
    """Return the files, with a further certificate for a stranger."""
    keys(folder, host=[])
    Authority(folder, days=1).issue(STRANGER)
    return Secured(folder, free_tcp_endpoint().replace("tcp/", "tls/"))
