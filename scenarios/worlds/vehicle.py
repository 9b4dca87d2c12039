"""The vehicle of a world: its body, pad, antenna and suspension."""

from dataclasses import dataclass

from scenarios.config import VehicleConfig
from scenarios.tracks.drive_config import SuspensionConfig
from scenarios.worlds.draws import Draws


@dataclass(frozen=True, slots=True, kw_only=True)
class Vehicle:
    """A body, and how it moves on its wheels."""

    body: VehicleConfig
    suspension: SuspensionConfig


def draw_vehicle(draws: Draws) -> Vehicle:
    """Return the vehicle of a world."""
    length_m, width_m = draws.number("vehicle.length_m"), draws.number("vehicle.width_m")
    roof_m, pad_m = draws.number("vehicle.roof_height_m"), draws.number("vehicle.pad_m")
    ahead_m = 0.5 * length_m * draws.number("vehicle.antenna_ahead_share")
    left_m = 0.5 * width_m * draws.number("vehicle.antenna_left_share")
    body = VehicleConfig(
        length_m=length_m,
        width_m=width_m,
        roof_height_m=roof_m,
        pad_size_m=(pad_m, pad_m),
        antenna_flu_m=(ahead_m, left_m, roof_m + draws.number("vehicle.antenna_above_m")),
    )
    suspension = SuspensionConfig(
        heave_hz=draws.number("vehicle.heave_hz"),
        pitch_hz=draws.number("vehicle.pitch_hz"),
        roll_hz=draws.number("vehicle.roll_hz"),
        damping=draws.number("vehicle.damping"),
        dive_rad_s2_m=draws.number("vehicle.dive_rad_s2_m"),
        lean_rad_s2_m=draws.number("vehicle.lean_rad_s2_m"),
        wheelbase_m=length_m * draws.number("vehicle.wheelbase_share"),
        track_m=width_m * draws.number("vehicle.track_share"),
    )
    return Vehicle(body=body, suspension=suspension)
