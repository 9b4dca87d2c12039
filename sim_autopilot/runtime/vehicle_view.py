"""The deck under the drone, as the vehicle's truth and its pad tell over Zenoh."""

import numpy as np

from link.frames.rotations import rotate
from link.messages import BodyTruth, PadGeometry
from link.payloads import cdr, json_messages
from link.payloads.checks import PayloadError
from link.records import replace
from link.zenoh.keys import Keys
from link.zenoh.session import Inbox, ZenohSession
from sim_autopilot.core.data import Deck
from sim_autopilot.runtime.config import VehicleConfig

_ASK_AGAIN_NS = 1_000_000_000
_ASK_TIMEOUT_S = 1.0
_SILENT_MAX_NS = 1_000_000_000
"""Of simulated time: an older truth is no longer carried on, the vehicle is gone."""


def deck_of(truth: BodyTruth, body: VehicleConfig) -> Deck:
    """Return the vehicle as the physics takes it."""
    q = truth.orientation_wxyz
    return Deck(
        t_ns=truth.t_ns,
        position_enu_m=np.array(truth.position_enu_m),
        orientation_wxyz=np.array(q),
        velocity_enu_m_s=np.array(rotate(q, truth.velocity_flu_m_s)),
        angular_velocity_enu_rad_s=np.array(rotate(q, truth.angular_velocity_flu_rad_s)),
        roof_size_m=(body.length_m, body.width_m),
        roof_height_m=body.roof_height_m,
        is_afloat=body.is_afloat,
    )


class VehicleView:
    """The newest deck; asks for the pad until it is told, and asks again after the vehicle was away.

    Args:
        session: an open one.
        keys: of the contract.
        body: its length and width, which nobody tells, and the rest until the pad is told.
    """

    def __init__(self, session: ZenohSession, keys: Keys, body: VehicleConfig) -> None:
        self._session = session
        self._keys = keys
        self._truths = session.subscribe(keys.vehicle_truth)
        self._body = body
        self._answers: Inbox | None = None
        self._asked_ns: int | None = None
        self._told = False
        self._deck: Deck | None = None
        self.bad_payloads = 0

    def deck(self, t_ns: int) -> Deck | None:
        """Return the vehicle as last heard of, None while there is none; its velocities carry it on to `t_ns`."""
        for sample in self._truths.take():
            self._hear(sample.payload)
        if self._deck is not None and t_ns - self._deck.t_ns > _SILENT_MAX_NS:
            self._deck, self._told = None, False
        if self._deck is not None and not self._told:
            self._learn_pad(t_ns)
        return self._deck

    def _hear(self, payload: bytes) -> None:
        try:
            truth = cdr.decode(BodyTruth, payload)
        except PayloadError:
            self.bad_payloads += 1
            return
        self._deck = deck_of(truth, self._body)

    def _learn_pad(self, t_ns: int) -> None:
        for sample in self._answers.take() if self._answers is not None else ():
            try:
                pad = json_messages.decode(PadGeometry, sample.payload)
            except PayloadError:
                self.bad_payloads += 1
                continue
            self._told = True
            self._body = self._body.model_copy(update={"roof_height_m": pad.height_m, "is_afloat": pad.is_afloat})
            if self._deck is not None:
                self._deck = replace(self._deck, roof_height_m=pad.height_m, is_afloat=pad.is_afloat)
        if not self._told and (self._asked_ns is None or t_ns - self._asked_ns >= _ASK_AGAIN_NS):
            self._asked_ns = t_ns
            self._answers = self._session.ask(self._keys.pad, b"", _ASK_TIMEOUT_S)
