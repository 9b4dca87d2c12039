"""Whole sorties: launch from the deck, stations, out of sight, home; what is ordered, and what they were worth."""
