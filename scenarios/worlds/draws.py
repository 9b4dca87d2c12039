"""The numbers that a world draws: one uniform number for each quantity, from a generator of its own.

A quantity that occurs several times in a world, such as the radius of a bend, has slots: `road.radius_m.3` is the
fourth one. Every world of the population draws the same names, used or not, so that they can be searched.
"""

from collections.abc import Mapping

from link.errors import UserError
from scenarios.simulation.noise import Seed, named_rng
from scenarios.worlds.distributions import Graded, Plain, Value
from scenarios.worlds.odd import Cases


class Draws:
    """The draws of one world.

    Args:
        quantities: by name.
        seed: of the world.
        chosen: the uniform number in (0, 1) of a drawn name, in place of the drawn one.

    Attributes:
        uniforms: the uniform number of every name that was drawn.
        values: the value of every name that was drawn.
    """

    def __init__(self, quantities: Mapping[str, Cases | Plain], seed: Seed, chosen: Mapping[str, float]) -> None:
        self._quantities = quantities
        self._seed = seed
        self._chosen = chosen
        self.uniforms: dict[str, float] = {}
        self.values: dict[str, Value] = {}

    def number(self, name: str, slot: int | None = None) -> float:
        """Draw a quantity that is a number."""
        value = self._drawn(name, slot)
        if isinstance(value, bool | str):
            raise TypeError(f"'{name}' is {value!r}, not a number")
        return value

    def word(self, name: str, slot: int | None = None) -> str:
        """Draw a quantity that is a choice of words."""
        return str(self._drawn(name, slot))

    def yes(self, name: str, slot: int | None = None) -> bool:
        """Draw a quantity that is so or not."""
        return self._drawn(name, slot) is True

    def check_chosen(self) -> None:
        """Raise where something was chosen that this world does not draw.

        Raises:
            UserError: naming it.
        """
        unknown = sorted(set(self._chosen) - set(self.uniforms))
        if unknown:
            raise UserError(f"'{unknown[0]}' is chosen, but a world draws no such quantity")

    def distribution(self, name: str) -> Plain:
        """Return the distribution that a quantity has in this world, by its name without a slot."""
        quantity = self._quantities[name]
        return quantity.cases[self.word(quantity.by)] if isinstance(quantity, Cases) else quantity

    def _drawn(self, name: str, slot: int | None) -> Value:
        full = name if slot is None else f"{name}.{slot}"
        if full not in self.values:
            u = self._uniform(full)
            self.uniforms[full] = u
            self.values[full] = self._value(name, u)
        return self.values[full]

    def _uniform(self, full: str) -> float:
        u = self._chosen.get(full)
        if u is None:
            return float(named_rng(self._seed, f"world {full}").random())
        if not 0.0 < u < 1.0:
            raise UserError(f"'{full}' is chosen as {u:g}; it must be between 0 and 1")
        return u

    def _value(self, name: str, u: float) -> Value:
        distribution = self.distribution(name)
        if isinstance(distribution, Graded):
            return distribution.quantile_at(self.number(distribution.quality), u)
        return distribution.quantile(u)
