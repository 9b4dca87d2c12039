"""What the autopilot remembers of its MAVLink links: what each streams, which is at hand, and what is to be sent."""

from msgspec import Struct

from link.mavlink.dialect import Message
from link.records import replace
from sim_autopilot.core.streams import Streams


class LinkMemory(Struct, frozen=True, kw_only=True):
    """What belongs to one link.

    Attributes:
        streams: what is sent unasked.
        listing: index of the next parameter of a list under way.
        ground_station: whether one was heard, or anybody at all where everybody counts: who gets texts.
    """

    streams: Streams
    listing: int | None = None
    ground_station: bool = False


class Links(Struct, frozen=True, kw_only=True):
    """The links, and the number of the one at hand."""

    each: tuple[LinkMemory, ...]
    at_hand: int = 0

    @property
    def here(self) -> LinkMemory:
        """The link at hand."""
        return self.each[self.at_hand]

    @property
    def texted(self) -> tuple[int, ...]:
        """The numbers of the links that get texts."""
        return tuple(number for number, link in enumerate(self.each) if link.ground_station)


def with_link_at_hand(links: Links, link: LinkMemory) -> Links:
    """Return the links with the one at hand as `link`."""
    each = list(links.each)
    each[links.at_hand] = link
    return replace(links, each=tuple(each))


class Later(Struct, frozen=True, kw_only=True):
    """A message to be sent at `boot_ns`, on the links on which its target is."""

    boot_ns: int
    message: Message


class Outbox(Struct, frozen=True, kw_only=True):
    """Messages to be sent later, and how many events were told, as the 16 bits on the wire count them."""

    later: tuple[Later, ...] = ()
    events: int = 0
