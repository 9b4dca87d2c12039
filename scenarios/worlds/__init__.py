"""A population of worlds: the operational design domain as distributions, and scenarios drawn from it."""
