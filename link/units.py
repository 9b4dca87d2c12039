"""Units of time, in one place."""

NS_PER_S = 1_000_000_000
