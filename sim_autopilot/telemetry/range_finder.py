"""The range finder that looks down: how far the ground or the vehicle's roof truly is, and its message."""

from math import inf

from link.frames.rotations import conjugate, rotate
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.physics.ground import ground_height
from sim_autopilot.telemetry.status import boot_ms


def distance_sensor(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return DISTANCE_SENSOR: how far off the ground or the roof is, downwards along the body's own axis."""
    model = config.range_finder
    told_m = _distance_down_m(memory) + memory.world.range_error_m
    return mavlink.MAVLink_distance_sensor_message(
        boot_ms(memory),
        round(100.0 * model.min_m),
        round(100.0 * model.max_m),
        round(100.0 * min(max(model.min_m, told_m), model.max_m)),
        mavlink.MAV_DISTANCE_SENSOR_LASER,
        0,
        mavlink.MAV_SENSOR_ROTATION_PITCH_270,
        0,
    )


def height_over_surface_m(memory: AutopilotMemory) -> float:
    """Return how far the ground or the roof is below the centre of mass."""
    return _distance_to_surface_m(memory, (0.0, 0.0, -1.0))


def _distance_down_m(memory: AutopilotMemory) -> float:
    q_WB = memory.plant.state.orientation_wxyz
    return _distance_to_surface_m(memory, rotate(q_WB, (0.0, 0.0, -1.0)))


def _distance_to_surface_m(memory: AutopilotMemory, beam: Vector3) -> float:
    """Return how far the roof, or else the ground, is from the centre of mass along `beam`, infinity where neither is.

    The simulation measures, so what the autopilot believes does not matter. The vehicle's sides are not seen.

    Args:
        memory: of the autopilot.
        beam: unit vector in W.
    """
    state, deck = memory.plant.state, memory.world.deck
    east_m, north_m, up_m = (float(one) for one in state.position_enu_m)
    if deck is None:
        return _along(up_m, beam[2])
    age_s = (state.t_ns - deck.t_ns) * 1e-9
    away = state.position_enu_m - deck.position_enu_m - age_s * deck.velocity_enu_m_s
    vehicle_m = (east_m - float(away[0]), north_m - float(away[1]))
    ground_m = _along(up_m - ground_height(east_m, north_m, *vehicle_m, deck.road_m, deck.lowest_m), beam[2])
    q_VW = conjugate(deck.orientation_wxyz)
    x, y, z = rotate(q_VW, (float(away[0]), float(away[1]), float(away[2])))
    forward, left, up = rotate(q_VW, beam)
    roof_m = _along(z - deck.roof_height_m, up)
    if not 0.0 <= roof_m < inf:
        return ground_m
    length_m, width_m = deck.roof_size_m
    is_on_roof = abs(x + roof_m * forward) <= 0.5 * length_m and abs(y + roof_m * left) <= 0.5 * width_m
    return roof_m if is_on_roof else ground_m


def _along(height_m: float, rise: float) -> float:
    """Return the length of a beam down to a plane `height_m` below its start, which it rises by `rise` per length."""
    return height_m / -rise if rise < 0.0 else inf
