"""Publishes status and plan on Zenoh."""

import math

from companion.config.companion import CompanionConfig
from companion.landing.outputs import plan_publication, status_publication
from companion.landing.state.step_data import StepOutputs
from companion.planning.guidance import Trajectory
from companion.runtime.step_clock import StepClock
from companion.runtime.vehicle_link import VehicleLink
from link.mavlink.session import MavlinkSession
from link.messages import LandingStatus, LinkStatus
from link.payloads.checks import PayloadError
from link.records import replace
from link.zenoh.keys import Keys, Publication

_PLAN_EVERY = 2  # statuses


class StatusPublisher:
    """Makes publications of what steps bring, at the status's rate and whenever there is news.

    Args:
        keys: of the Zenoh contract.
        config: with the rate.
        is_on: make any.
    """

    def __init__(self, keys: Keys, config: CompanionConfig, *, is_on: bool) -> None:
        self._is_on = is_on
        self.unpublished = 0
        """Statuses and plans that hold what no message has room for."""
        self._keys = keys
        self._period_ns = 1e9 / config.ground_station.status_rate_hz
        self._publications: list[Publication] = []
        self._status_ns: int | None = None
        self._statuses = 0

    def take(self) -> list[Publication]:
        """Return what is to be put on Zenoh, once."""
        taken, self._publications = self._publications, []
        return taken

    def is_due(self, outputs: StepOutputs, monotonic_ns: int) -> bool:
        """Return whether the outputs of this step are published."""
        since_ns = math.inf if self._status_ns is None else monotonic_ns - self._status_ns
        return self._is_on and (outputs.text is not None or since_ns >= self._period_ns)

    def publish(self, status: LandingStatus, way: Trajectory | None, clock: StepClock, yaw_rad: float) -> None:
        """Take what a step brought.

        Args:
            status: with what is known of the links.
            way: planned, its offsets from the step; None while nothing is flown.
            clock: of the step.
            yaw_rad: the heading that is flown, from East counter-clockwise.
        """
        self._status_ns = clock.monotonic_ns
        self._statuses += 1
        try:
            self._publications.append(status_publication(self._keys, status))
            if way is not None and self._statuses % _PLAN_EVERY == 0:
                self._publications.append(plan_publication(self._keys, way, clock.t_ns, yaw_rad))
        except PayloadError:  # a flight goes on without being seen
            self.unpublished += 1


def with_links(
    status: LandingStatus, session: MavlinkSession, vehicle: VehicleLink, open_to_strangers: tuple[str, ...]
) -> LandingStatus:
    """Return the status of a step with what is known of the links.

    Args:
        status: as the step made it.
        session: to the autopilot.
        vehicle: the link to it.
        open_to_strangers: which links are.
    """
    links = LinkStatus(
        mavlink_bad_bytes=session.statistics.codec.bad_bytes,
        zenoh_bad_payloads=vehicle.refusals.total,
        refused=vehicle.refused_lately(),
        open_to_strangers=open_to_strangers,
    )
    return replace(status, links=links)
