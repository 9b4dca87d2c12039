"""Load, memory and temperature of the companion's computer."""

import time
from contextlib import suppress
from pathlib import Path

import psutil  # type: ignore[import-untyped]  # it has no annotations

from companion.component.identity import ComputerLoad

_MIB = 1 << 20
_THERMAL = Path("/sys/class/thermal/thermal_zone0/temp")  # of the processor on the small computers that have one
_PERIOD_S = 1.0


class ComputerWatch:
    """Reads the load once a second."""

    def __init__(self) -> None:
        self._read_s = time.monotonic()
        psutil.cpu_percent(percpu=True)  # from now on

    def poll(self) -> ComputerLoad | None:
        """Return the load of the last second, None while it is not over."""
        now_s = time.monotonic()
        if now_s - self._read_s < _PERIOD_S:
            return None
        self._read_s = now_s
        memory = psutil.virtual_memory()
        return ComputerLoad(
            cores_percent=tuple(psutil.cpu_percent(percpu=True)),
            ram_used_mib=(memory.total - memory.available) // _MIB,
            ram_total_mib=memory.total // _MIB,
            uptime_ms=round((time.time() - psutil.boot_time()) * 1e3),
            temperature_c=_temperature_c(),
        )


def _temperature_c() -> float | None:
    with suppress(OSError, ValueError):
        return int(_THERMAL.read_text(encoding="ascii")) * 1e-3
    return None
