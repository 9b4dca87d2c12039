"""How often and how long a MAVLink session tries."""

from dataclasses import dataclass, field, fields

from link.mavlink.clock_map import ClockConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionConfig:
    """Periods and patience of a session.

    Attributes:
        heartbeat_period_s: of our own heartbeat, 1 Hz by the MAVLink heartbeat protocol.
        link_lost_after_s: of silence, three of the autopilot's heartbeats.
        command_retry_s: wait for an acknowledgement before the command is sent again.
        command_attempts: how often a command is sent at most.
        command_progress_timeout_s: patience after an IN_PROGRESS.
        parameter_retry_s: wait for a parameter before it is asked for again.
        parameter_attempts: how often it is asked for at most.
        interval_attempts: how often a message interval is asked for before the next one has its turn.
        stream_silent_after_s: a granted stream that stays away so long is asked for again.
        timesync_fast_period_s: between the first clock questions.
        timesync_fast_count: how many are asked so quickly, 2 s worth.
        timesync_period_s: between the later ones.
        restart_threshold_s: boot time falling back by more is a restart, by less a late message.
        restart_confirmations: so many messages in a row have to say so.
        records_input: keep the frames received for `take_input`.
        clock: how clocks are followed.

    Raises:
        ValueError: A number is not positive.
    """

    heartbeat_period_s: float = 1.0
    link_lost_after_s: float = 3.0
    command_retry_s: float = 0.5
    command_attempts: int = 5
    command_progress_timeout_s: float = 10.0
    parameter_retry_s: float = 0.5
    parameter_attempts: int = 6
    interval_attempts: int = 3
    stream_silent_after_s: float = 5.0
    timesync_fast_period_s: float = 0.1
    timesync_fast_count: int = 20
    timesync_period_s: float = 0.5
    restart_threshold_s: float = 1.0
    restart_confirmations: int = 3
    records_input: bool = False
    clock: ClockConfig = field(default_factory=ClockConfig)

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, int | float) and not isinstance(value, bool) and not value > 0:
                raise ValueError(f"{one.name} must be positive, is {value}")


def duration_ns(seconds: float) -> int:
    """Seconds as whole nanoseconds."""
    return round(seconds * 1e9)
