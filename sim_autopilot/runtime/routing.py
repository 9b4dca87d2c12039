"""Which link leads to which system: learnt from what is heard, as every MAVLink system with several links has to.

Source: https://mavlink.io/en/guide/routing.html: broadcasts go to all other links, what is addressed goes where the
addressee was heard, and nothing goes back to where it came from or to somebody never heard.
"""

from link.mavlink.dialect import Message, mavlink

_EVERYBODY = 0
_STAY = (
    mavlink.MAVLINK_MSG_ID_RADIO,  # what a radio says is for its own link
    mavlink.MAVLINK_MSG_ID_RADIO_STATUS,
    mavlink.MAVLINK_MSG_ID_SETUP_SIGNING,  # a secret must not travel on
)
_ROUTES_MAX = 64  # a network has fewer; noise would make up thousands


class Routes:
    """Who was heard where.

    Args:
        system: our own.
        component: our own; what claims to be from us is neither learnt nor passed on.
        links: how many there are.
    """

    def __init__(self, system: int, component: int, links: int) -> None:
        self._own = (system, component)
        self._links = range(links)
        self._heard: dict[tuple[int, int], frozenset[int]] = {}  # the latest is the last

    def learn(self, message: Message, link: int) -> None:
        """Takes note that the sender of a message is on a link."""
        source = (message.get_srcSystem(), message.get_srcComponent())
        if source == self._own or source[0] == _EVERYBODY:
            return
        links = self._heard.pop(source, frozenset())
        self._heard[source] = links if link in links else links | {link}
        if len(self._heard) > _ROUTES_MAX:
            del self._heard[next(iter(self._heard))]

    def onward(self, message: Message, link: int) -> list[int]:
        """Returns the links to which a message that came on `link` is passed on."""
        source = (message.get_srcSystem(), message.get_srcComponent())
        if len(self._links) == 1 or source == self._own or message.get_msgId() in _STAY:
            return []
        if target_of(message) == self._own:
            return []
        return [other for other in self.towards(message) if other != link]

    def towards(self, message: Message) -> list[int]:
        """Returns the links on which the addressee of a message was heard; all of them for a broadcast."""
        system, component = target_of(message)
        if system == _EVERYBODY:
            return list(self._links)
        heard = (
            links for (one, part), links in self._heard.items() if one == system and component in (part, _EVERYBODY)
        )
        return sorted(frozenset[int]().union(*heard))


def target_of(message: Message) -> tuple[int, int]:
    """Returns the system and component that a message is for; 0 stands for all."""
    return getattr(message, "target_system", _EVERYBODY), getattr(message, "target_component", _EVERYBODY)
