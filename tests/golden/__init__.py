"""Golden runs: what a few flights were like, as small JSON; `pytest --update-golden tests/golden` rewrites them."""
