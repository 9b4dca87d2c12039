"""The keys of the Zenoh contract: which name carries what."""

from dataclasses import dataclass

from msgspec import Struct

from link.errors import UserError

_RESERVED = "*$?#@/"


@dataclass(frozen=True, slots=True)
class Keys:
    """All keys of one namespace, one vehicle and one drone.

    A namespace may have several chunks (`site/decklander`), a vehicle or drone is one chunk.

    Raises:
        UserError: If a name is empty or holds a character that Zenoh gives a meaning of its own.
    """

    namespace: str = "decklander"
    vehicle: str = "vehicle"
    drone: str = "drone"

    def __post_init__(self) -> None:
        """Check the three names."""
        for chunk in self.namespace.split("/"):
            _check_chunk("--ns", self.namespace, chunk)
        _check_chunk("--vehicle", self.vehicle, self.vehicle)
        _check_chunk("--drone", self.drone, self.drone)
        if self.vehicle == self.drone:
            raise UserError(f"--vehicle and --drone are both {self.drone!r}: give them different names")

    @property
    def fix(self) -> str:
        """The vehicle's position, `link.messages.Fix`."""
        return f"{self.namespace}/{self.vehicle}/fix"

    @property
    def fix_velocity(self) -> str:
        """The vehicle's velocity, `link.messages.FixVelocity`."""
        return f"{self.namespace}/{self.vehicle}/fix_velocity"

    @property
    def imu(self) -> str:
        """The vehicle's attitude and rates, `link.messages.VehicleImu`."""
        return f"{self.namespace}/{self.vehicle}/imu"

    @property
    def alive(self) -> str:
        """The vehicle's liveliness token."""
        return f"{self.namespace}/{self.vehicle}/alive"

    @property
    def pad(self) -> str:
        """The queryable that tells `link.messages.PadGeometry`."""
        return f"{self.namespace}/{self.vehicle}/pad"

    @property
    def vehicle_truth(self) -> str:
        """The vehicle's true motion, simulation only, `link.messages.BodyTruth`."""
        return f"{self.namespace}/{self.vehicle}/truth"

    @property
    def pad_pose(self) -> str:
        """What a detector on the drone sees of the pad, `link.messages.PadSighting`."""
        return f"{self.namespace}/{self.drone}/pad_pose"

    @property
    def camera_image(self) -> str:
        """What the drone's camera sees, `link.messages.CameraImage`."""
        return f"{self.namespace}/{self.drone}/camera/image"

    @property
    def camera_compressed(self) -> str:
        """The same as a file, `link.messages.CompressedPicture`."""
        return f"{self.namespace}/{self.drone}/camera/image/compressed"

    @property
    def pad_view(self) -> str:
        """What the detector saw with the pad drawn in, while one listens, `link.messages.CompressedPicture`."""
        return f"{self.namespace}/{self.drone}/pad_view/compressed"

    @property
    def pad_annotations(self) -> str:
        """In recordings, what the detector saw, to be drawn on the picture of the same stamp."""
        return f"{self.namespace}/{self.drone}/pad_view/annotations"

    @property
    def detector_alive(self) -> str:
        """The liveliness token of `pad-detector`."""
        return f"{self.namespace}/{self.drone}/pad_detector/alive"

    @property
    def landing_status(self) -> str:
        """How the landing goes, `link.messages.LandingStatus`."""
        return f"{self.namespace}/{self.drone}/landing/status"

    @property
    def landing_plan(self) -> str:
        """The path that the companion intends to fly, `link.messages.Plan`."""
        return f"{self.namespace}/{self.drone}/landing/plan"

    @property
    def landing_command(self) -> str:
        """The queryable that takes `link.messages.Command` and answers `CommandReply`."""
        return f"{self.namespace}/{self.drone}/landing/command"

    def companion_alive(self, companion: str) -> str:
        """The liveliness token of a companion of this drone; `*` for all of them."""
        return f"{self.namespace}/{self.drone}/companion/alive/{companion}"

    def landing_claim(self, drone: str, companion: str) -> str:
        """The liveliness token of a companion that lands `drone` on this vehicle; `*` for all of them."""
        return f"{self.namespace}/{self.vehicle}/landing/{drone}/{companion}"

    @property
    def drone_truth(self) -> str:
        """The drone's true motion, simulation only, `link.messages.BodyTruth`."""
        return f"{self.namespace}/{self.drone}/truth"

    @property
    def drone_rotors(self) -> str:
        """The drone's true rotor speeds, simulation only, `link.messages.RotorTruth`."""
        return f"{self.namespace}/{self.drone}/truth/rotors"

    def record(self, name: str) -> str:
        """Return the topic of what the companion alone knows: in recordings, some of it for views on Zenoh, too."""
        return f"{self.namespace}/{self.drone}/companion/{name}"

    @property
    def clock(self) -> str:
        """The simulator's time, simulation only, `link.program.clock.ClockTick`."""
        return f"{self.namespace}/clock"


def _check_chunk(option: str, name: str, chunk: str) -> None:
    if not chunk:
        raise UserError(f"{option} {name!r} has an empty part: write a name such as 'decklander', without stray '/'")
    for character in chunk:
        if character in _RESERVED or character.isspace() or not character.isprintable():
            raise UserError(f"{option} {name!r} holds {character!r}: use letters, digits, '_', '-' and '.' in a name")


class Publication(Struct, frozen=True):
    """What a program without I/O of its own wants put on Zenoh: a payload, the key it goes to and its encoding."""

    key: str
    payload: bytes
    encoding: str
