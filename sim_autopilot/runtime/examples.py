"""What the help of `sim-autopilot` shows as examples."""

EXAMPLES = {
    "": (
        "sim-autopilot",
        "sim-autopilot --firmware ardupilot --instance 1 --wind 5 --turbulence moderate",
        "sim-autopilot --mavlink udpout:127.0.0.1:14540 --mavlink tcpin:127.0.0.1:5760",
    ),
}
