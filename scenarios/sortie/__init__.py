"""Whole sorties in lockstep: launch from a driving deck, stations, out of sight, home; and what they were worth."""
