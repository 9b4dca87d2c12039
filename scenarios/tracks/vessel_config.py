"""A ship, and the sea that it goes through."""

from typing import Annotated, Literal

from pydantic import Field

from link.program.toml_config import Positive, StrictModel
from scenarios.tracks.departure import Departure


class HullConfig(StrictModel):
    """A ship's hull; that of DTMB 5415, a destroyer whose model many towing tanks have measured (ITTC, SIMMAN 2008)."""

    length_m: Positive = 142.0
    breadth_m: Positive = 19.06
    draught_m: Positive = 6.15
    block_coefficient: Annotated[float, Field(gt=0.0, le=1.0)] = 0.507
    metacentric_height_m: Positive = 1.95
    # Of radii of gyration of 0.37 of the breadth, and a quarter of added inertia: 2 pi k / sqrt(g GM).
    roll_period_s: Positive = 11.3
    roll_damping: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.1  # share of the critical, with bilge keels


class VesselTrack(StrictModel):
    """A ship that goes straight on through waves from about ahead, as for flying; its deck is the vehicle."""

    kind: Literal["vessel"]
    departure: Departure = Departure()
    significant_height_m: Positive
    modal_period_s: Positive
    speed_range_m_s: tuple[Positive, Positive] = (1.0, 8.0)  # drawn for each seed
    off_bow_max_rad: Annotated[float, Field(ge=0.0, le=1.5708)] = 0.7854  # where waves come from, drawn; 45 degrees
    deck_forward_m: float = -57.0  # of amidships; the flight deck of DTMB 5415's class is right aft
    acceleration_m_s2: Positive = 0.5
    run_s: Positive = 240.0  # behind the waiting point
    hull: HullConfig = HullConfig()
