"""The Zenoh session: how a program meets others, the keys, and where samples wait."""
