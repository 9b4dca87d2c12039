"""What vehicles drive: roads, the speed along them, and the tracks made of both."""
