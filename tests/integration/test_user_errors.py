"""A user's mistake ends each program with exit code 2 and one line that names it and what to change."""

import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import companion.app
import companion.eyes.app
import scenarios.app
import scenarios.commands.ground_vehicle
import sim_autopilot.app
from link.program.cli import run_app
from scenarios.processes.programs import MODULES
from tests.integration.programs import Programs

APPS = {
    "companion": companion.app.app,
    "ground-vehicle": scenarios.commands.ground_vehicle.app,
    "pad-detector": companion.eyes.app.app,
    "scenarios": scenarios.app.app,
    "sim-autopilot": sim_autopilot.app.app,
}

FREE = "--mavlink udpin:127.0.0.1:0"

FILES = {
    "key.toml": "[descent.alignment]\nbegin_distnce_m = 1.0\n",
    "range.toml": "[abort]\nfix_age_max_s = -1.0\n",
    "kind.toml": '[guidance]\nkind = "mpcc"\n',
    "not.toml": "= 3\n",
    "wind.toml": "[wind]\nmean_mps = 2.0\n",
    "parameter.toml": "[parameters]\nMPC_XY_VEL_MAXX = 2.0\n",
    "scenario.toml": 'base = "straight_5"\ntime_limits_s = 20.0\n',
    "zenoh.json5": "{ mode: ",
    "empty.json": "{}",
    "camera.yaml": "image_width: 1280\n",
    "board.toml": "size_m = [1.0, 1.0]\ntags = [{id = 900, center_m = [0.0, 0.0], side_m = 0.5}]\n",
}

MISTAKES = [
    # devices
    ("companion", "--mavlink udpn:127.0.0.1:14540", ["udpn:127.0.0.1:14540", "did you mean udpin:127.0.0.1:14540?"]),
    ("companion", "--mavlink udpin:no-such.invalid:14540", ["no-such.invalid", "write its address"]),
    ("companion", "--mavlink /dev/ttyNONE,57600", ["/dev/ttyNONE", "plugged in"]),
    ("companion", "--mavlink udpin:127.0.0.1:{udp}", ["port {udp} is in use", "choose another port"]),
    ("scenarios", "world straight_5 --mavlink foo", ["'foo'", "udpin:HOST:PORT, udpout:HOST:PORT"]),
    ("ground-vehicle", "--nmea udpin:0.0.0.0", ["'udpin:0.0.0.0'", "did you mean udpin:0.0.0.0:10110?"]),
    ("scenarios", "attack --mavlink foo", ["'foo'", "udpin:HOST:PORT, udpout:HOST:PORT"]),
    ("scenarios", "attack --stranger 127.0.0.1:7447", ["--stranger '127.0.0.1:7447'", "tcp/127.0.0.1:7447"]),
    # endpoints and names on Zenoh
    ("companion", f"{FREE} -e tpc/127.0.0.1:7447", ["--connect 'tpc/127.0.0.1:7447'", "tcp/127.0.0.1:7447"]),
    ("companion", f"{FREE} -m pear", ["--mode 'pear'", "peer, client, router"]),
    ("companion", f"{FREE} --zenoh-config none.json5", ["none.json5", "No such file"]),
    ("companion", f"{FREE} --ns a*b", ["--ns 'a*b'", "use letters"]),
    ("companion", f"{FREE} --vehicle one --drone one", ["'one'", "different names"]),
    ("ground-vehicle", "--scenario straight_5 -l tcp/127.0.0.1:{tcp}", ["{tcp}", "in use", "choose another port"]),
    ("scenarios", "world straight_5 -l tcp/127.0.0.1:{tcp}", ["{tcp}", "in use", "choose another port"]),
    ("scenarios", "command start -e tcp:127.0.0.1:1", ["'tcp:127.0.0.1:1'", "write it as tcp/127.0.0.1:7447"]),
    ("scenarios", "world straight_5 --zenoh-config zenoh.json5", ["zenoh.json5", "line 1, column 9", "check commas"]),
    # scenarios
    ("ground-vehicle", "", ["--scenario", "scenarios list"]),
    ("ground-vehicle", "--scenario straight_5 --pad-height 1.0", ["--pad", "leave them out with --scenario"]),
    ("ground-vehicle", "--scenario straight_5+sensors=rtkk", ["'rtkk'", "'rtk'"]),
    ("scenarios", "run strait_5", ["'strait_5'", "'straight_5'"]),
    ("scenarios", "run straight_5+wnd=calm", ["'wnd=calm'", "did you mean +wind=calm?"]),
    ("scenarios", "run circle_5+foo=bar", ["'foo=bar'", "sensors, wind, link", "=PRESET"]),
    ("scenarios", "retries straight_5+firmware=px4 --firmware ardupilot", ["names its firmware", "--firmware"]),
    ("scenarios", "retries straight_5+firmware=px4", ["names its firmware", "leave out that"]),
    ("scenarios", "run none.toml", ["none.toml", "cannot be read"]),
    ("scenarios", "run scenario.toml", ["scenario.toml", "'time_limits_s'", "did you mean run.time_limit_s or "]),
    ("scenarios", "ros2 topics --domain 77", ["domain 77", "check --domain, and -e"]),
    ("scenarios", "faults --fault nosuch", ["'nosuch'", "pilot changes mode"]),
    ("scenarios", "faults --fault pilot --phase nosuch", ["'nosuch'", "align"]),
    ("scenarios", "faults --wire --fault battery", ["'battery'", "Zenoh router gone for 3 s"]),
    ("companion", "check --duration inf", ["--duration inf", "from 1 to 3600"]),
    ("companion", "keys new --days 99999999", ["--days 99999999", "from 1 to 36500"]),
    # configurations
    ("companion", "--config not.toml", ["not.toml", "line 1"]),
    ("companion", "--config key.toml", ["key.toml", "'descent.alignment.begin_distnce_m'", "'begin_distance_m'"]),
    ("companion", "--config range.toml", ["range.toml", "abort.fix_age_max_s = -1.0", "at least 1e-09"]),
    ("companion", "--set limits=3", ["limits = 3", "it is a table"]),
    ("companion", "--firmware pixhawk", ["--firmware': 'pixhawk' is not one of", "px4"]),
    ("companion", "--set silent_vehicle.pad_height_m=1 --set estimator.kind=ukf", ["with the command line", "'imm'"]),
    ("companion", "--config kind.toml", ["kind.toml", "guidance.kind", '"mpcc"', "'mpc'"]),
    ("sim-autopilot", "--config wind.toml", ["wind.toml", "'wind.mean_mps'", "'mean_m_s'"]),
    ("sim-autopilot", "--config parameter.toml", ["MPC_XY_VEL_MAXX", "MPC_XY_VEL_MAX"]),
    # the camera
    ("pad-detector", "run", ["--calibration"]),
    ("pad-detector", "run --calibration none.yaml", ["none.yaml", "cannot be read"]),
    ("pad-detector", "run --calibration camera.yaml", ["camera.yaml", "camera_matrix", "cam0"]),
    ("pad-detector", "print --board board.toml", ["board.toml", "0 to 586", "900"]),
    ("pad-detector", "print --side 9", ["--side 9", "0.1 to 5 m"]),
    ("pad-detector", "print --side 0.5", ["--save-board FILE", "--board FILE"]),
    ("pad-detector", "print --out none/pad.pdf", ["none/pad.pdf", "--out"]),
    ("scenarios", "camera straight_5", ["straight_5", "+camera=day"]),
    # options and values
    ("companion", "--stat", ["--stat", "--start"]),
    ("companion", "start", ["'start'", "There are check, keys, reasons"]),
    ("companion", "--timeout -1", ["--timeout", "0"]),
    ("companion", "--system-id 256", ["--system-id", "255"]),
    ("sim-autopilot", "--firmware px5", ["firmware", '"px5"', "px4"]),
    ("sim-autopilot", "--turbulence strong", ['"strong"', "'none', 'light', 'moderate' or 'severe'"]),
    ("sim-autopilot", "--datum 100 0 0", ["latitude_deg = 100.0", "at most 90"]),
    ("scenarios", "run", ["NAME|FILE"]),
    ("scenarios", "run straight_5 --speed 0", ["--speed", "0.1"]),
    ("scenarios", "run straight_5 --out key.toml", ["key.toml", "--out"]),
    ("scenarios", "command strt", ["'strt'", "did you mean start?"]),
    ("scenarios", "command up", ["'up'", "start, abort, hold"]),
    ("scenarios", "command follow --offset 1 nan 3", ["--offset 1.0 nan 3.0", "three finite numbers"]),
    ("scenarios", "command follow --offset 1 2 -e tcp/127.0.0.1:1", ["--offset -e", "3 numbers, X Y Z"]),
    ("scenarios", "command follow --offset 1 2", ["--offset", "3 values, X Y Z", "1 2 is too few"]),
    ("scenarios", "command follow --offset 1 2 3 4", ["--offset", "3 values, X Y Z", "4 is one too many"]),
    ("ground-vehicle", "--nmea none --pad-size 1 2 3", ["--pad-size", "LENGTH WIDTH", "3 is one too many"]),
    ("scenarios", "run straight_5 --speed nan", ["--speed nan", "a number from 0.1 to 50"]),
    ("companion", "--timeout nan", ["--timeout nan", "a number, 0 or more"]),
    ("scenarios", "run straight_5 --seed 1.5", ["--seed 1.5", "a whole number, 0 or more"]),
    ("scenarios", "retries --height 1 --height 4", ["--height 4", "begins 3.5 m over the pad"]),
    ("scenarios", "bench --pairs -3", ["--pairs -3", "--against FOLDER"]),
    ("ground-vehicle", "--nmea udpin:127.0.0.1:0 --seed 0 --timeout 60", ["--seed and --timeout:", "--scenario"]),
    ("ground-vehicle", "--gpsd 127.0.0.1 --use-sim-time", ["--use-sim-time:", "leave that out"]),
    ("ground-vehicle", "--mavlink udpin:127.0.0.1:0 --depart-at-once", ["--depart-at-once:", "leave that out"]),
    ("companion", f"{FREE} --signing-stamps none.stamps", ["--signing-stamps", "give --signing-key"]),
    ("companion", f"check {FREE} --signing-stamps none.stamps", ["--signing-stamps", "give --signing-key"]),
    ("scenarios", "fly straight_5 --ship inf", ["--ship inf", "from 0.1 to 50"]),
    ("scenarios", "view none --road straight_5", ["none", "leave out --road"]),
    ("scenarios", "view none --seed 3", ["--seed", "give --road"]),
    ("scenarios", "view --seed 3", ["--seed", "give --road"]),
    ("scenarios", "view --foxglove-layout none/layout.json", ["none/layout.json", "another --foxglove-layout"]),
    ("scenarios", "run straight_5 --lockstep --speed 1", ["--lockstep", "leave out --speed"]),
    ("scenarios", "table none --seeds 5 --workers 1", ["--seeds and --workers", "leave them out with none"]),
    ("scenarios", "table none --markdown --json", ["--markdown and --json", "one of them"]),
    ("scenarios", "report none", ["none", "no such folder", "a run or a campaign"]),
    ("scenarios", "replay .", ["no recording", "without --no-record"]),
    ("companion", "keys made --name a/b", ["--name 'a/b'", "192.168.4.1"]),
    ("companion", "check --restore empty.json", ["empty.json", "no parameters", "--write kept"]),
    ("companion", "check --write --restore empty.json", ["--write", "--restore", "give one of them"]),
    ("companion", "check --write --keep .", ["--keep .", "is a folder"]),
    ("companion", "--zenoh-config .", ["--zenoh-config .", "Is a directory"]),
]


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Give a folder with files and ports that are in use."""
    folder = tmp_path_factory.mktemp("mistakes")
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    with socket.socket() as tcp, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        for used in (tcp, udp):
            used.bind(("127.0.0.1", 0))
        tcp.listen()
        yield {"folder": str(folder), "tcp": str(tcp.getsockname()[1]), "udp": str(udp.getsockname()[1])}


@pytest.fixture
def here(places: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, str]]:
    """Be in that folder; the programs' handlers of signals are taken back."""
    monkeypatch.chdir(Path(places["folder"]))
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield places
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(("name", "line", "words"), MISTAKES, ids=[f"{name} {line}" for name, line, _ in MISTAKES])
def test_a_mistake_is_one_line_that_names_it_and_exit_code_2(
    here: dict[str, str], capfd: pytest.CaptureFixture[str], name: str, line: str, words: list[str]
) -> None:
    assert run_app(name, APPS[name], line.format(**here).split()) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"{name}: ")
    for word in words:
        assert word.format(**here) in err


@pytest.mark.parametrize("option", ["--mavlink", "--watch"])
def test_flight_with_a_wrong_device_makes_no_folder(
    here: dict[str, str], capfd: pytest.CaptureFixture[str], option: str
) -> None:
    assert run_app("scenarios", APPS["scenarios"], ["fly", "straight_5", "--out", "flown", option, "foo"]) == 2
    assert "device 'foo' has no known form" in capfd.readouterr().err
    assert not (Path(here["folder"]) / "flown").exists()


@pytest.mark.parametrize("arguments", ["companion --print-config", "scenarios list", "companion --help"])
def test_output_that_finds_no_space_is_one_line_and_exit_code_2(arguments: str) -> None:
    name, *rest = arguments.split()
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        ended = subprocess.run([sys.executable, "-m", name, *rest], stdout=full, stderr=subprocess.PIPE, check=False)
    assert (ended.returncode, ended.stderr.count(b"\n")) == (2, 1), ended.stderr
    assert b"no space is left" in ended.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", MODULES)
def test_each_program_has_its_help_as_a_module(name: str) -> None:
    with Programs() as programs:
        program = programs.start(name, "--help")
        assert program.wait() == 0
    assert program.err.all == []
    assert program.out.all[0].startswith(f"Usage: {name} ")
