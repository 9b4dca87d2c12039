"""What the help of `companion` shows as examples, by command."""

EXAMPLES = {
    "": (
        "companion --mavlink /dev/ttyACM0,921600 --zenoh-config companion.json5 --vehicle car",
        "companion --mavlink udpin:127.0.0.1:14540 --start     # beside `scenarios world straight_5`",
        "companion --print-config > companion.toml",
    ),
    "check": (
        "companion check --mavlink /dev/ttyACM0,921600 --speed-max 8",
        "companion check --mavlink udpin:0.0.0.0:14540 --write",
        "companion check --mavlink udpin:0.0.0.0:14540 --restore parameters_before.json",
    ),
    "keys": ("companion keys keys --host 192.168.4.1",),
    "reasons": ("companion reasons OFFSET_UNKNOWN",),
}
