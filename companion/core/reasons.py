"""Every reason for a phase, a wait or an abort, once, with its sentence.

What decides, counts or compares does so by the `Reason`; the sentence, with its numbers, is made where it is shown.
"""

from enum import Enum

from msgspec import Struct


class Reason(Enum):
    """A reason; its value is the sentence, with a place for each of the values that go with it."""

    __hash__ = object.__hash__  # by identity, as members compare: a name is hashed again at every look-up

    # The landing goes on.
    WAITING_FOR_START = "waiting for a start"
    OPERATOR_STARTS = "commanded: start"
    AT_WAITING_POINT = "waiting for the vehicle"
    VEHICLE_MAY_DEPART = "vehicle stands: the drone flies to it in {:.0f} s (chase.parked_wait_s)"
    VEHICLE_STANDS_FAR = (
        "vehicle stands {:.1f} m away, chase.passing_distance_m is {:g}: bring it nearer, or raise that"
    )
    VEHICLE_PASSES_FAR = (
        "vehicle's course is {:.1f} m beside the drone, chase.passing_distance_m is {:g}: drive nearer, or raise that"
    )
    VEHICLE_IS_PAST = "vehicle drives away, {:.0f} m past the drone: let it come again"
    VEHICLE_PASSES = "vehicle passes at {:.1f} m/s"
    VEHICLE_STANDS = "vehicle stands"
    VEHICLE_DRIVES = "vehicle drives"
    OVER_PAD = "{:.1f} m from the pad"
    ALIGNED = "aligned"
    CONTACT = "contact: {}"
    DISPUTED_CONTACT = "contact against the range finder: {}"
    HARD_CONTACT = "hard contact: {}"
    HELD_UP = "held up"
    MOTORS_RUN = "motors still run {:.0f} s after the contact: stay away, use the kill switch"
    MOTORS_OFF = "motors are off on the pad"
    HEARD = "heard"
    HEARD_AGAIN = "heard again: what was broken off goes on"
    RETRY = "retry {} of {}"

    # A sortie goes on.
    OPERATOR_LAUNCHES = "commanded: launch"
    OPERATOR_FOLLOWS = "commanded: follow"
    OPERATOR_RETURNS = "commanded: return"
    DECK_QUIET = "deck is quiet"
    CLEAR_OF_DECK = "{:.1f} m above the deck"
    VEHICLE_NEAR = "{:.0f} m from the vehicle"
    VEHICLE_FOUND = "vehicle is heard again"
    HOME_SOON = "the way home has to begin in {:.0f} s: command return"
    HOME_NOW = "comes home: the battery lasts {:.0f} s above its reserve, way and landing take {:.0f} s"
    DECK_RESTLESS = "deck was not quiet within {:g} s: it {}"
    LIFT_OFF_TOO_LONG = "lift-off took longer than {:g} s"
    RETURN_TOO_LONG = "did not come home within {:g} s: it holds"

    # A descent stays above the pad for a while.
    NOT_OVER_PAD = "waits above the pad: the drone is not over the pad"
    OFF_CENTRE = "waits above the pad: farther than {:g} m from the pad's centre"
    MOMENT_RISKY = "waits above the pad: a contact would be unsafe with more than {:.0%}"

    # An approach is unsafe, or takes too long.
    OPERATOR_ABORTS = "commanded: abort"
    OPERATOR_HOLDS = "commanded: hold"
    VEHICLE_DATA_OLD = "vehicle data too old"
    VEHICLE_UNCERTAIN = "vehicle position too uncertain"
    VEHICLE_LINK_LOST = "vehicle's link lost"
    VEHICLE_CLOCK_AHEAD = "vehicle's clock is ahead, or the autopilot's link is too slow"
    STAMPS_STEPPED = "stamps of the fixes have stepped: the vehicle's clock, or the autopilot's, was set"
    VEHICLE_CONTRADICTS_ITSELF = "vehicle data contradict themselves: {:.0%} of its {} were rejected: see {}"
    SEEN_ELSEWHERE = (
        "pad is seen where both receivers say that it is not: see the detector's board and mounting, both receivers, "
        "the vehicle's antenna_to_pad_m and heading, or --receiver-frames apart where they have two base stations"
    )
    SIGHTINGS_DISAGREE = (
        "sightings of the pad contradict each other, or the vehicle's heading does: see the camera's mounting (pad_pose"
        " is in the drone's FLU), and let one detector alone see one pattern and nobody else publish pad_pose"
    )
    SIGHTINGS_UNPLACED = (
        "pad not seen: its sightings are stamped when nobody knew where the drone was: see the detector's clock, and "
        "let it stamp each picture with the time of its exposure"
    )
    SIGHTINGS_VAGUE = (
        "pad is seen, but too seldom or too vaguely to be landed on: let the detector see it 5 times a second or more, "
        "and see what covariance it states"
    )
    SIGHTINGS_IMPOSSIBLE = (
        "sightings move the pad as no vehicle moves: let the detector stamp each picture with the time of its exposure,"
        " and see the camera's mounting and the covariance that is stated"
    )
    VEHICLE_OUTRUNS = "vehicle faster than the limit"
    STATION_OUTRUNS = "vehicle turns too fast for a station so far from it: give a nearer one, or in the frame north"
    OWN_POSITION_OLD = "own position too old"
    OWN_ATTITUDE_OLD = "own attitude too old"
    SETPOINT_NOT_FOLLOWED = "setpoint not followed"
    OUTSIDE_CONE = "outside the descent cone"
    TOO_FAST_NEAR_PAD = "too fast against the pad"
    WOULD_BLOW_OFF = "the air pushes with up to {:.2f} of the drone's weight, its gear holds {:.2f}: drive slower"
    CONTACT_RISKY = "a safe contact is forecast with {:.0%} only"
    SEEN_TOO_NEAR = "range finder sees less room than there is to the pad"
    TOO_FAR_FROM_START = "too far from the start"
    BELOW_PAD = "below the pad without contact"
    NOTHING_TOUCHED = "nothing touched"
    SETPOINTS_UNHEARD = "nothing shows that the autopilot hears setpoints: the drone may hover"
    ROAD_BELOW = "range finder sees the road where the pad should be"
    STRAYS = "not over the pad in time"
    ALIGNMENT_LOST = "alignment lost"
    PAD_TO_BE_SEEN = "pad to be seen again"
    PAD_NOT_SEEN = "pad not seen"
    OFFSET_UNKNOWN = "pad not seen, and both receivers have no common frame: {}"
    TAKEOFF_TOO_LONG = "takeoff took longer than {:g} s"
    CHASE_TOO_LONG = "chase took longer than {:g} s"
    ALIGN_TOO_LONG = "align took longer than {:g} s"
    DESCENT_TOO_LONG = "descend took longer than {:g} s"
    TILT_TOO_SMALL = (
        "to stay above the pad in this air takes {:.0f} degrees of tilt, and the autopilot's limit leaves {:.0f} to "
        "plan with: raise that limit or drive slower"
    )
    ABOVE_AFTER_CONTACT = "{:.1f} m above the pad after contact"
    BELOW_AFTER_CONTACT = "below the pad after contact"
    LEFT_AFTER_CONTACT = "left behind by the pad after contact, in the air"

    # Where on the vehicle the pad is, is not known.
    PAD_NOT_DESCRIBED = "the vehicle has not described its pad"
    HEADING_UNKNOWN = "vehicle heading unknown"
    TURNS_ON_SPOT = "vehicle turns on the spot: no landing until it has turned"
    HEADING_LOST = "vehicle heading too vague for its pad"
    HEADING_OFF_COURSE = "vehicle heading is {:.0f} degrees off its course"

    # No other approach is made.
    BROKEN_OFF = "broken off by the operator"
    NO_VEHICLE_DATA = "no vehicle data"
    HEARD_WITH_BREAKS = "vehicle or autopilot heard only with gaps"
    NO_RETRY_LEFT = "no retry left: {}"

    # Another one is in command.
    AUTOPILOT_LOST = "out of touch with the autopilot"
    AUTOPILOT_FAILSAFE = "autopilot failsafe"
    AUTOPILOT_RESTARTED = "autopilot restarted"
    MODE_CHANGED = "mode changed by the pilot"
    MOTORS_KILLED = "motors stopped by the kill switch or a flight termination"
    DISARMED = "disarmed"
    CONTROL_REFUSED = "the autopilot did not give control in time"
    ARMING_REFUSED = "the autopilot did not arm in time: {}"

    # A landing on this vehicle cannot be done.
    DRONE_TAKEN = "another companion is there for this drone, and was there first: end one of them"
    SYSTEM_ID_SHARED = (
        "two autopilots answer under the same system id, and both would arm: give each drone its own (MAV_SYS_ID, "
        "SYSID_THISMAV, MAV_SYSID), and see --system-id"
    )
    VEHICLE_TAKEN = "{} lands on this vehicle, or stands on it: wait until it has gone"
    PAD_CHANGED = (
        "the vehicle describes another pad than the one flown to: see which is right, change the mode or land, and "
        "start again"
    )
    STAMPS_LATE = (
        "vehicle's fixes come {:.2f} s after their stamps, abort.fix_age_max_s is {:g}: set its clock by GNSS or NTP, "
        "or use a faster link"
    )
    FIXES_RARE = (
        "vehicle's fixes come {:.2f} s apart and {:.2f} s after their stamps, abort.fix_age_max_s is {:g}: set its "
        "receiver to 5 Hz or more, or use a better link"
    )
    STAMPS_AHEAD = (
        "vehicle's fixes come {:.2f} s before their stamps: set its clock by GNSS or NTP, or the autopilot's; "
        "or the autopilot's link is too slow"
    )
    VEHICLE_TOO_FAST = "vehicle at {:.1f} m/s needs {:.1f} m/s, the limit is {:.1f}: raise {} or drive slower"
    VEHICLE_TOO_FAR = (
        "vehicle at {:.1f} m/s goes {:.0f} m in {:g} s, limits.range_max_m is {:g}: raise it or drive slower"
    )
    HEIGHTS_APART = (
        "heights cannot be compared: the vehicle's are above the ellipsoid, and the autopilot tells its own above the "
        "sea only (no alt_ellipsoid in GPS_RAW_INT): set autopilot.geoid_height_m"
    )
    AUTOPILOT_WARNS = (
        "the autopilot reports a failsafe (battery, radio, ground station): end its cause, see its own messages"
    )
    MEASUREMENTS_REJECTED = "vehicle data contradict themselves: {:.0%} of its {} in 10 s were rejected: see {}"
    BATTERY_LOW = "battery at {:.0f} %, limits.battery_min_share is {:.0f} %: charge it"
    PAD_TOO_SMALL = "pad is {:.2f} m wide, {:.2f} m are needed for feet {:.2f} m about the axis: use a larger pad"
    ROAD_ELSEWHERE = "the vehicle's road {}"
    ROOF_TOO_HIGH = "waiting {:.1f} m above the pad, {:.1f} m are needed: {}"

    # A command is refused.
    MOTORS_STOPPING = "the motors are being switched off on the ground: start again once they stand"
    NOTHING_TO_DO = "nothing to {} in phase {}"
    GUIDES_ONLY = "guides the autopilot's own precision landing, and flies nothing: choose that mode"
    NO_AUTOPILOT = "no autopilot is connected"
    NO_ORIGIN = "the autopilot has no origin yet"
    VEHICLE_UNHEARD = "nothing usable has come from the vehicle{}: see its program and clock, --vehicle and -e"
    NO_OWN_POSITION = "the autopilot reports no local position yet"
    NO_OWN_ATTITUDE = "the autopilot's attitude is too old"
    IN_FAILSAFE = "the autopilot is in a failsafe: the pilot has to change its mode first"
    RIDES_ALONG = "the drone stands on the vehicle, which drives at {:.1f} m/s: stop it, or launch with the motors off"
    NOT_ON_DECK = "the drone does not stand on the vehicle's pad: command start"
    STATION_TOO_FAR = "station is {:.6g} m from the pad, sortie.offset_max_m is {:g}: raise it or give a nearer one"
    STATION_IN_VEHICLE = (
        "station is in the vehicle or too low: {:.1f} m or more beside the pad and {:.1f} m or more above it, or {:.1f}"
        " m or more above it anywhere"
    )
    VEHICLE_OUT_OF_RANGE = "vehicle is {:.0f} m away, limits.range_max_m is {:g}: raise it or let the vehicle come back"
    VEHICLE_DRIVES_OFF = "vehicle drives off at {:.1f} m/s, the drone can fly home at {:.1f}: drive slower"
    PILOT_SWITCHES_OFF = "the pilot's switch has just ended what was under way: command it again"
    MOTORS_OFF_AT_SWITCH = "the motors are off: arm, take off, then switch, or set autopilot.pilot_switch.arms"
    NOT_FLOWN = "the companion does not fly the drone: start it first, then {}"
    RALLY_TOO_FAR = (
        "sortie.rally_point_deg_m is {:.0f} m away, limits.range_max_m is {:g}: set a nearer one, or raise the limit"
    )
    DRONE_UNKNOWN = "the drone's position is not known"


class Cause(Struct, frozen=True):
    """A reason with the values that its sentence tells, as they were when it was decided."""

    reason: Reason
    values: tuple[float | str, ...] = ()


def sentence(cause: Cause) -> str:
    """Return what is told of a cause."""
    return cause.reason.value.format(*cause.values)


def same_or_new(told: Cause | None, now: Cause | None) -> Cause | None:
    """Keep the numbers that were told as long as it is for the same reason: they change in every step."""
    return told if told is not None and now is not None and told.reason is now.reason else now
