"""Many landings of some cells: flown, kept, summed up and compared."""
