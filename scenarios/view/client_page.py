"""The page that a browser loads: viser's own, with our title and icon, and a panel that leaves room on a phone."""

from pathlib import Path

import viser

_ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E%3Crect x='2' y='22' width='28'"
    " height='7' rx='2' fill='%236e7682'/%3E%3Cpath d='M6 8h20M16 8v10m-5-4 5 5 5-5' stroke='%232563eb'"
    " stroke-width='3' fill='none'/%3E%3C/svg%3E"
)
# On a phone viser's panel is a sheet of 60 % of the height that lies over the middle of the scene.
_STYLE = """@media (max-width: 48em) {
  div[style*="max-height: 60%"] { max-height: 40% !important; width: 100% !important; }
  div[style*="max-height: 60%"] div[style*="width: 20em"] { width: 100% !important; }
}"""


def write_client_page(folder: Path) -> None:
    """Write the page into `folder`."""
    plain = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")
    head = f'<title>Decklander</title><link rel="icon" href="{_ICON}"><style>{_STYLE}</style>'
    (folder / "index.html").write_text(plain.replace("<title>Viser</title>", head), encoding="utf-8")
