"""The pad as its owner describes it: by a TOML file, by options, or both."""

from pathlib import Path
from typing import Any

from link.errors import UserError
from link.messages import PadGeometry
from link.payloads.json_messages import Height, Lever, Rise, Size
from link.program.toml_config import StrictModel, load_config

_OPTIONS = {"size_m": "--pad-size", "height_m": "--pad-height", "antenna_to_pad_m": "--antenna-to-pad"}


class PadConfig(StrictModel):
    """The pad; what is missing is asked for."""

    size_m: tuple[Size, Size] | None = None  # along and across the vehicle
    height_m: Height | None = None  # of the pad above the road
    antenna_to_pad_m: tuple[Lever, Lever, Rise] | None = None  # to the pad's middle: forward, left, up
    is_afloat: bool = False  # heights are above the water then


def pad_geometry(file: Path | None, **options: Any) -> PadGeometry:
    """Return the pad.

    Args:
        file: TOML with `size_m`, `height_m` and `antenna_to_pad_m`, None for no file.
        **options: of the same names, from the command line, None where not given.

    Raises:
        UserError: something is missing or cannot be.
    """
    config = load_config(file, PadConfig, options)
    for name, option in _OPTIONS.items():
        if getattr(config, name) is None:
            where = "--pad FILE" if file is None else str(file)
            raise UserError(f"the pad's {name} is missing: give {option}, or {name} in {where} (docs/vehicle.md)")
    return PadGeometry(**config.model_dump())
