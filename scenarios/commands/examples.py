"""What the helps of `scenarios` and `ground-vehicle` show as examples, by command."""

GROUND_VEHICLE = {
    "": (
        "ground-vehicle --gpsd 127.0.0.1:2947 --pad pad.toml --vehicle car --zenoh-config vehicle.json5",
        "ground-vehicle --nmea /dev/ttyUSB0,115200 --pad pad.toml",
        "ground-vehicle --scenario straight_5 --use-sim-time",
    ),
}
SCENARIOS = {
    "": (
        "scenarios list",
        "scenarios run straight_5",
        "scenarios report runs/latest",
    ),
    "list": ("scenarios list", "scenarios list --json"),
    "run": (
        "scenarios run straight_5 --view",
        "scenarios run straight_5 --set track.speed_m_s=6 --set system.companion.descent.wait.height_m=1.05",
        "scenarios run circle_5+sensors=nominal+wind=gust --lockstep --seed 7",
        "scenarios run world:urban@123 --lockstep --firmware ardupilot",
    ),
    "world": ("scenarios world straight_5", "scenarios world circle_5+wind=nominal --speed 2"),
    "command": (
        "scenarios command start",
        "scenarios command abort --drone drone2",
        "scenarios command follow --offset -6 2 4 --frame course",
    ),
    "campaign": (
        "scenarios campaign straight_5 circle_5+wind=nominal --seeds 100 --out runs/first",
        "scenarios campaign world --seeds 200 --firmware both",
        "scenarios campaign --resume runs/first",
    ),
    "compare": ("scenarios compare runs/first runs/changed", "scenarios compare runs/A runs/B --apart-from system"),
    "table": ("scenarios table runs/first", "scenarios table report --markdown"),
    "figures": ("scenarios figures runs/latest", "scenarios figures report --out figures"),
    "report": ("scenarios report runs/latest",),
    "replay": ("scenarios replay runs/latest", "scenarios replay runs/latest --config changed.toml"),
    "view": ("scenarios view", "scenarios view runs/latest", "scenarios view runs/latest --foxglove 8765"),
    "falsify": ("scenarios falsify world:urban --landings 500 --seed 1 --out runs/urban",),
    "rare": ("scenarios rare brake_7+sensors=degraded+link=degraded --particles 100",),
    "bench": ("scenarios bench", "scenarios bench straight_5+sensors=nominal --against ../before"),
    "fuzz": ("scenarios fuzz --end autopilot --firmware ardupilot --link tcpin --frames 100000",),
    "sortie": ("scenarios sortie straight_10 --seeds 2 --firmware both", "scenarios sortie urban --first-seed 30000"),
    "retries": ("scenarios retries --seeds 20", "scenarios retries circle_5 --height 0.5 --firmware ardupilot"),
    "attack": (
        "scenarios attack",
        "scenarios attack --mavlink udpout:127.0.0.1:14540 --stranger tcp/127.0.0.1:7447",
    ),
    "faults": ("scenarios faults --workers 1 --firmware px4",),
    "fly": (
        "scenarios fly straight_5 --ship 5     # with ArduPilot's own simulation, started before",
        "scenarios fly straight_5 --sortie     # from a pad on the ground",
    ),
    "identify": (
        "scenarios identify --mavlink udpin:127.0.0.1:14540     # with PX4's or ArduPilot's own simulation",
        "scenarios identify --firmware px4 --parameter MPC_XY_P=1.2 --json",
    ),
    "camera": ("scenarios camera straight_5+camera=day",),
    "eyes": ("scenarios eyes --frames 800 --bare 400 --seed 100",),
    "ros2": ("scenarios ros2 topics",),
    "ros2 topics": ("scenarios ros2 topics -e tcp/127.0.0.1:7447",),
}
