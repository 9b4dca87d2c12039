"""The messages that travel as JSON: pad geometry, orders with their replies, and the landing status.

Reading is strict about types and finiteness, and what is given twice is refused. So is a command with a name too many,
which might have been meant to change what the command does; reports may hold more than this version knows.
"""

import json
from typing import Annotated, Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import to_json

from link.errors import own_words
from link.messages import (
    VEHICLE_HEIGHT_MAX_M,
    VEHICLE_LENGTH_MAX_M,
    Command,
    CommandReply,
    ContactForecast,
    LandingStatus,
    LinkStatus,
    Order,
    PadGeometry,
    Station,
    StationFrame,
)
from link.payloads.checks import PayloadError
from link.program.text import printable

__all__ = ["JSON_ENCODING", "LANDING_STATUS_SCHEMA", "PayloadError", "decode", "encode"]

JSON_ENCODING = "application/json"

Message = PadGeometry | Order | CommandReply | LandingStatus
M = TypeVar("M", bound=Message)

Coordinates = tuple[float, float, float]
Count = Annotated[int, Field(ge=0)]
Size = Annotated[float, Field(gt=0.0, le=VEHICLE_LENGTH_MAX_M)]
Height = Annotated[float, Field(ge=0.0, le=VEHICLE_HEIGHT_MAX_M)]
Lever = Annotated[float, Field(ge=-VEHICLE_LENGTH_MAX_M, le=VEHICLE_LENGTH_MAX_M)]
Rise = Annotated[float, Field(ge=-VEHICLE_HEIGHT_MAX_M, le=VEHICLE_HEIGHT_MAX_M)]


class _Report(BaseModel):
    model_config = ConfigDict(frozen=True, strict=True, allow_inf_nan=False, extra="ignore")


class _PadGeometry(_Report):
    size_m: tuple[Size, Size]
    height_m: Height
    antenna_to_pad_m: tuple[Lever, Lever, Rise]
    is_afloat: bool = False


class _Order(_Report):
    model_config = ConfigDict(extra="forbid")

    command: Command
    offset_m: Coordinates | None = None
    frame: StationFrame | None = None

    @model_validator(mode="after")
    def _has_a_station_to_follow_only(self) -> Self:
        if self.command is Command.FOLLOW and self.offset_m is None:
            raise ValueError("follow needs offset_m, [ahead, left, up] in m")
        if self.command is not Command.FOLLOW and (self.offset_m is not None or self.frame is not None):
            raise ValueError(f"{self.command.value} takes no offset_m and no frame: give them to follow")
        return self


class _CommandReply(_Report):
    accepted: bool
    reason: str


Probability = Annotated[float, Field(ge=0.0, le=1.0)]


class _ContactForecast(_Report):
    """How a descent that goes on now ends, in probabilities."""

    model_config = ConfigDict(title="Contact forecast", from_attributes=True)

    in_s: Annotated[float | None, Field(description="s until the contact; null where none is expected")]
    s1: Annotated[Probability, Field(description="a contact within the limits of S1 or S2")]
    s2: Annotated[Probability, Field(description="within those of S2")]
    unsafe: Annotated[Probability, Field(description="beyond those of S1")]
    broken_off: Annotated[Probability, Field(description="none: the drone waits or breaks off before")]
    misses_position: Annotated[Probability, Field(description="unsafe, by its place most of all")]
    misses_speed: Annotated[Probability, Field(description="unsafe, by its horizontal speed")]
    misses_sink: Annotated[Probability, Field(description="unsafe, by its sink rate")]
    misses_tilt: Annotated[Probability, Field(description="unsafe, by its tilt")]


class _LinkStatus(_Report):
    mavlink_bad_bytes: Annotated[Count, Field(description="bytes from the autopilot that were no message")]
    zenoh_bad_payloads: Annotated[Count, Field(description="payloads that were refused")]
    refused: Annotated[str, Field(description="what was refused most in the last 5 s, and why; empty if nothing")]
    open_to_strangers: Annotated[
        tuple[str, ...], Field(description="links by which somebody without a key could take part, in words")
    ]


class _LandingStatus(_Report):
    """How the landing of the drone on the vehicle goes."""

    model_config = ConfigDict(title="Landing status")

    stamp_ns: Annotated[Count, Field(description="UTC of this status, ns")]
    phase: Annotated[str, Field(description="phase of the landing")]
    reason: Annotated[str, Field(description="why it waits, held off or aborted; empty if there is nothing to say")]
    reason_code: Annotated[str, Field(description="the reason without its numbers, for programs")]
    relative_position_enu_m: Annotated[
        Coordinates | None,
        Field(description="of the drone's feet from the pad's centre, east north up, m; null if unknown"),
    ]
    relative_velocity_enu_m_s: Annotated[
        Coordinates | None, Field(description="drone against the pad, east north up, m/s; null if unknown")
    ]
    height_above_pad_m: Annotated[float | None, Field(description="m, of the feet; null if unknown")]
    time_to_contact_s: Annotated[float | None, Field(description="s; null unless descending")]
    armed: Annotated[bool, Field(description="whether the autopilot reports its motors armed")]
    fix_age_s: Annotated[float | None, Field(description="s since the newest fix was taken; null before the first")]
    flown_by: Annotated[
        str, Field(description="companion while it follows the setpoints, failsafe, else other; empty if unknown")
    ]
    battery_share: Annotated[float | None, Field(description="left of the battery, 0 to 1; null if unknown")]
    contact_forecast: Annotated[
        _ContactForecast | None, Field(description="of the contact, while it descends; it decides nothing")
    ]
    unverified: Annotated[
        tuple[str, ...], Field(description="what of the pad's place is believed since nothing can verify it, in words")
    ]
    station_offset_m: Annotated[
        Coordinates | None,
        Field(description="station that is kept: ahead, left, up of the pad's centre in its frame, m; null if none is"),
    ]


def _status_schema() -> dict[str, Any]:
    """Return the schema of a status, whose links stand beside its own fields."""
    own, links = _LandingStatus.model_json_schema(), _LinkStatus.model_json_schema()
    properties, required = links["properties"] | own["properties"], [*links["required"], *own["required"]]
    begin = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return begin | own | {"properties": properties, "required": required}


LANDING_STATUS_SCHEMA = _status_schema()
"""The JSON schema of `{ns}/{drone}/landing/status`."""

_MODELS: dict[type[object], type[_Report]] = {
    PadGeometry: _PadGeometry,
    Order: _Order,
    CommandReply: _CommandReply,
    LandingStatus: _LandingStatus,
}


def encode(message: Message) -> bytes:
    """Return `message` as a JSON payload.

    Raises:
        PayloadError: If it holds what must not be sent, such as a number that is not finite.
    """
    model = _MODELS[type(message)]
    try:
        if isinstance(message, Order):
            return _Order.model_validate(_order_fields(message)).model_dump_json(exclude_none=True).encode()
        checked = _validated(model, message)
        if isinstance(message, LandingStatus):
            return to_json(_validated(_LinkStatus, message.links).model_dump() | checked.model_dump())
        return checked.model_dump_json().encode()
    except ValidationError as error:
        raise _payload_error(error) from error


def decode(message_type: type[M], payload: bytes) -> M:
    """Return the message of type `message_type` that a JSON payload holds.

    Raises:
        PayloadError: If the bytes are not such a message.
    """
    try:
        model = _MODELS[message_type].model_validate_json(payload)
        links = _LinkStatus.model_validate_json(payload) if isinstance(model, _LandingStatus) else None
    except ValidationError as error:
        raise _payload_error(error) from error
    json.loads(payload, object_pairs_hook=_check_names, parse_int=str)  # only names are looked at
    fields = {name: getattr(model, name) for name in type(model).model_fields}
    forecast = fields.get("contact_forecast")
    if isinstance(forecast, _ContactForecast):
        fields["contact_forecast"] = ContactForecast(**forecast.model_dump())
    if links is not None:
        fields["links"] = LinkStatus(**links.model_dump())
    message = _order(model) if isinstance(model, _Order) else message_type(**fields)
    if not isinstance(message, message_type):
        raise TypeError(f"the model of {message_type.__name__} gave a {type(message).__name__}")
    return message


def _check_names(pairs: list[tuple[str, object]]) -> None:
    """Check that no name stands twice in an object: either may be what was meant.

    Raises:
        PayloadError: If one does.
    """
    seen = set[str]()
    for name, _ in pairs:
        if name in seen:
            raise PayloadError(f"{printable(name)}: given twice")
        seen.add(name)


def _validated(model: type[_Report], message: object) -> _Report:
    return model.model_validate({name: getattr(message, name) for name in model.model_fields})


def _order_fields(order: Order) -> dict[str, object]:
    station = order.station
    own = {} if station is None else {"offset_m": station.offset_m, "frame": station.frame}
    return {"command": order.command, **own}


def _order(model: _Order) -> Order:
    if model.offset_m is None:
        return Order(command=model.command)
    frame = StationFrame.VEHICLE if model.frame is None else model.frame
    return Order(command=model.command, station=Station(offset_m=model.offset_m, frame=frame))


def is_possible(pad: PadGeometry) -> bool:
    """Return whether a vehicle may have such a pad."""
    try:
        encode(pad)
    except PayloadError:
        return False
    return True


def _payload_error(error: ValidationError) -> PayloadError:
    first = error.errors(include_url=False, include_input=False)[0]
    where = ".".join(str(part) for part in first["loc"])
    why = own_words(first["msg"])
    return PayloadError(f"{where}: {why}" if where else why)
