"""The autopilot's memory and its links: which one is at hand, and what each of them wants."""

from dataclasses import replace

from sim_autopilot.memory import AutopilotMemory, LinkMemory
from sim_autopilot.streams import Streams


def at_link(memory: AutopilotMemory, link: int) -> AutopilotMemory:
    """Return `memory` with link number `link` at hand."""
    if link == memory.link:
        return memory
    links = list(memory.links)
    links[memory.link] = LinkMemory(
        streams=memory.streams, listing=memory.listing, ground_station=memory.ground_station
    )
    there = links[link]
    return replace(
        memory,
        link=link,
        links=tuple(links),
        streams=there.streams,
        listing=there.listing,
        ground_station=there.ground_station,
    )


def link_streams(memory: AutopilotMemory) -> tuple[Streams, ...]:
    """Return the streams of every link."""
    return tuple(memory.streams if link == memory.link else there.streams for link, there in enumerate(memory.links))


def text_links(memory: AutopilotMemory) -> tuple[int, ...]:
    """Return the links that get texts."""
    return tuple(
        link
        for link, there in enumerate(memory.links)
        if (memory.ground_station if link == memory.link else there.ground_station)
    )
