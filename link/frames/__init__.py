"""Where things are: rotations, geodetic coordinates, and the local frames of autopilots."""
