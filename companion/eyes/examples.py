"""What the help of `pad-detector` shows as examples, by command."""

EXAMPLES = {
    "": ("pad-detector run --source /dev/video0 --calibration camera.yaml --mounting mounting.toml",),
    "run": (
        "pad-detector run --source /dev/video0 --calibration camera.yaml --mounting mounting.toml",
        "pad-detector run --source picamera --calibration camera.yaml --mounting mounting.toml",
        "pad-detector run --source zenoh --calibration camera.yaml --mounting mounting.toml --board b.toml",
    ),
    "print": ("pad-detector print --out pad.pdf", "pad-detector print --side 0.5 --first-id 63 --out small.pdf"),
    "calibrate": (
        "pad-detector calibrate --source /dev/video0 --out camera.yaml",
        "pad-detector calibrate --source pictures/ --pictures 60 --out camera.yaml",
    ),
    "latency": ("pad-detector latency --source /dev/video0 --calibration camera.yaml",),
    "bench": ("pad-detector bench",),
}
