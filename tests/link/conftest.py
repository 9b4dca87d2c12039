"""How property tests run: the same examples every time, and no deadline on a machine that others use as well."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
