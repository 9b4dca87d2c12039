"""Where the drone is to be, and the virtual model that leads it there."""
