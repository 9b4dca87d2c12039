"""From a forecast of the deck to the trajectory that meets it."""
