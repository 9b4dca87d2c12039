"""What the programs share to talk to each other: frames, clocks, MAVLink and Zenoh."""
