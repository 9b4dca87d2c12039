"""The models of how autopilots follow setpoints, over the planner's horizon, each made once."""

from functools import lru_cache

from companion.autopilots.response import Cascade, ResponseModel
from companion.landing.targets import HORIZON_OFFSETS_S


@lru_cache(maxsize=16)  # the gains of some landings; nothing that a link tells fills the memory
def response_to(cascade: Cascade) -> ResponseModel:
    """Return the model of a cascade; 2 ms, and the gains of an autopilot come one by one in each of many landings."""
    return ResponseModel(cascade, HORIZON_OFFSETS_S)
