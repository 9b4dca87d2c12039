"""Recordings as MCAP files: written beside a loop, and read."""
