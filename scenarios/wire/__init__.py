"""A run over real links, kept in time with the clock."""
