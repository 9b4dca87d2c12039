"""The check as a person and as a script read it."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from companion.check.assessment import is_ready
from companion.check.findings import Finding, Level

_STYLES = {Level.PASS: "green", Level.WARN: "yellow", Level.FAIL: "bold red"}


def print_table(findings: Sequence[Finding], speed_m_s: float) -> None:
    """Print one line for each finding, and the sum."""
    table = Table(box=SIMPLE_HEAD, title=f"for a vehicle at {speed_m_s:g} m/s", title_justify="left")
    table.add_column("")
    table.add_column("what", no_wrap=True)
    table.add_column("found")
    table.add_column("what to do, and why")
    for one in findings:
        to_do = ": ".join(part for part in (one.advice, one.reason) if part)
        table.add_row(one.level.value, one.name, one.found, to_do, style=_STYLES[one.level])
    console = Console()
    console.print(table)
    counts = [f"{sum(one.level is level for one in findings)} {level.value}" for level in Level]
    console.print(", ".join(counts))


def as_table(findings: Sequence[Finding], speed_m_s: float) -> dict[str, Any]:
    """Return the same content for JSON."""
    rows = [{**asdict(one), "level": one.level.value} for one in findings]
    return {"speed_m_s": speed_m_s, "ready": is_ready(findings), "findings": rows}
