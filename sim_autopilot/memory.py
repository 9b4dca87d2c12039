"""What the autopilot's step remembers, what comes in and what goes out."""

from msgspec import Struct, field

from link.mavlink.dialect import Message
from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Array, Deck, PlantState, Reference
from sim_autopilot.core.links import Later, LinkMemory, Links, Outbox, with_link_at_hand
from sim_autopilot.core.modes import Modes
from sim_autopilot.core.parameters import Values
from sim_autopilot.core.places import Places
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.flight.climb import Climb
from sim_autopilot.flight.flight import ModeFlight
from sim_autopilot.flight.follow import Leader
from sim_autopilot.flight.land_detector import Landing
from sim_autopilot.flight.manual import Sticks
from sim_autopilot.flight.precision_landing import Target
from sim_autopilot.missions.fence import Fence
from sim_autopilot.missions.flight import NO_PROGRESS, Progress
from sim_autopilot.missions.items import Item
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.own_state import NO_ERROR
from sim_autopilot.plant.plant import PlantMemory
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.safety.failsafes import NOTHING_NOTICED, Watch
from sim_autopilot.safety.failures import NO_FAILURES, Failures
from sim_autopilot.setpoints.guided import Guided
from sim_autopilot.setpoints.setpoints import NO_SETPOINTS, Setpoints


class Boot(Struct, frozen=True, kw_only=True):
    """When it was booted (UTC), and when it boots again, in ns since then; whether that forgets all parameters."""

    start_ns: int
    again_ns: int | None = None
    forgets: bool = False


class Tuning(Struct, frozen=True, kw_only=True):
    """The parameters' values, the flight settings that they amount to, and the drone with the envelope of these."""

    values: Values
    settings: FlightSettings
    plant_config: PlantConfig


class Course(Struct, frozen=True, kw_only=True, eq=False):
    """What steering changes.

    Attributes:
        flight: what the mode remembers.
        guided: what ArduCopter's GUIDED remembers.
        climb: the lift-off under way.
        landing: of the land detector.
        following: what the flight controller was last told.
    """

    flight: ModeFlight
    guided: Guided
    climb: Climb | None
    landing: Landing
    following: Reference | None


class Heard(Struct, frozen=True, kw_only=True, eq=False):
    """What others have said of where to fly.

    Attributes:
        setpoints: the companion's.
        sticks: the pilot's, None before the first.
        target: of a precision landing, None before the first sighting.
        leader: who is followed, None before his first word.
    """

    setpoints: Setpoints = NO_SETPOINTS
    sticks: Sticks | None = None
    target: Target | None = None
    leader: Leader | None = None


class World(Struct, frozen=True, kw_only=True, eq=False):
    """What is about the drone: the vehicle, for the range finder with its error, and the air, for WIND_COV."""

    deck: Deck | None = None
    range_error_m: float = 0.0
    wind_enu_m_s: Vector3 = (0.0, 0.0, 0.0)


class MissionMemory(Struct, frozen=True, kw_only=True):
    """The items of the mission, how far it is flown, and the fence in W."""

    items: tuple[Item, ...] = ()
    progress: Progress = NO_PROGRESS
    fence: Fence = ()


class SafetyMemory(Struct, frozen=True, kw_only=True):
    """What the failsafes have noticed, and what has failed on purpose."""

    watch: Watch = NOTHING_NOTICED
    failures: Failures = NO_FAILURES


class AutopilotMemory(Struct, frozen=True, kw_only=True, eq=False):
    """Everything that the autopilot knows from one step to the next.

    Attributes:
        boot: the last one and the next.
        plant: the drone.
        now: the same as the autopilot believes it to be, in plain numbers.
        tuning: by the parameters.
        modes: flown and intended.
        armed_ns: when the motors were started, in ns since boot; None with the motors off.
        course: what it flies.
        heard: of where to fly.
        places: origin, home and chart.
        world: about the drone.
        mission: and fence.
        safety: failsafes and failures.
        links: of MAVLink.
        outbox: what is still to be sent.
        station: the services' memory, which only they read.
    """

    boot: Boot
    plant: PlantMemory
    now: Snapshot
    tuning: Tuning
    modes: Modes
    armed_ns: int | None
    course: Course
    heard: Heard
    places: Places
    world: World
    mission: MissionMemory
    safety: SafetyMemory
    links: Links
    outbox: Outbox
    station: object


class AutopilotInputs(Struct, frozen=True, kw_only=True, eq=False):
    """What the autopilot gets for one step, which ends at `t_ns` (UTC).

    Attributes:
        t_ns: 10 ms after the last one.
        messages: received since then, decoded.
        links: the number of the link of each of them; empty when all came on the first.
        deck: the vehicle at its own time, None without one.
        wind_enu_m_s: (3,).
        own_error: (6,) m and m/s in W, of the autopilot's estimate of its position and velocity.
        range_error_m: of what its range finder would measure now.
    """

    t_ns: int
    messages: tuple[Message, ...]
    deck: Deck | None
    wind_enu_m_s: Array
    own_error: Array = field(default_factory=lambda: NO_ERROR)
    range_error_m: float = 0.0
    links: tuple[int, ...] = ()


class AutopilotOutputs(Struct, frozen=True, kw_only=True, eq=False):
    """What the autopilot sends, and the truth.

    Attributes:
        messages: to be sent, in order.
        links: the number of the link of each of them, None for wherever its target is, everywhere without a target.
        state: the drone as it truly is.
    """

    messages: tuple[Message, ...]
    links: tuple[int | None, ...]
    state: PlantState


def with_flight(memory: AutopilotMemory, flight: ModeFlight) -> AutopilotMemory:
    """Return `memory` with another flight of its mode."""
    return replace(memory, course=replace(memory.course, flight=flight))


def with_guided(memory: AutopilotMemory, guided: Guided) -> AutopilotMemory:
    """Return `memory` with another wish or path of GUIDED."""
    return replace(memory, course=replace(memory.course, guided=guided))


def with_link(memory: AutopilotMemory, link: LinkMemory) -> AutopilotMemory:
    """Return `memory` with the link at hand changed."""
    return replace(memory, links=with_link_at_hand(memory.links, link))


def with_later(memory: AutopilotMemory, *later: Later) -> AutopilotMemory:
    """Return `memory` with messages to be sent later."""
    return replace(memory, outbox=replace(memory.outbox, later=(*memory.outbox.later, *later)))


def at_link(memory: AutopilotMemory, link: int) -> AutopilotMemory:
    """Return `memory` with link number `link` at hand."""
    return memory if link == memory.links.at_hand else replace(memory, links=replace(memory.links, at_hand=link))
