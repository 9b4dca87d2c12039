import pytest

from link.errors import UserError
from link.transports.device import NetworkDevice, SerialDevice, parse_device


@pytest.mark.parametrize(
    ("device", "kind", "host", "port"),
    [
        ("udpin:0.0.0.0:14540", "udpin", "0.0.0.0", 14540),  # noqa: S104 - only taken apart
        ("udpout:drone.local:14550", "udpout", "drone.local", 14550),
        ("tcp:127.0.0.1:5760", "tcp", "127.0.0.1", 5760),
        ("tcpin:[::1]:0", "tcpin", "::1", 0),
        ("UDPIN:127.0.0.1:1", "udpin", "127.0.0.1", 1),
    ],
)
def test_a_network_device_is_taken_apart(device: str, kind: str, host: str, port: int) -> None:
    parsed = parse_device(device)
    assert parsed == NetworkDevice(kind=kind, host=host, port=port)
    assert parse_device(str(parsed)) == parsed


def test_a_serial_device_is_taken_apart() -> None:
    parsed = parse_device("/dev/ttyACM0,921600")
    assert parsed == SerialDevice(path="/dev/ttyACM0", baud=921600)
    assert str(parsed) == "/dev/ttyACM0,921600"


@pytest.mark.parametrize(
    ("device", "advice"),
    [
        ("udp:127.0.0.1:14550", "did you mean udpin:127.0.0.1:14550?"),
        ("tcpout:drone:5760", "did you mean tcp:drone:5760?"),
        ("udpin:14540", "did you mean udpin:127.0.0.1:14540?"),
        ("tcp:drone", "did you mean tcp:drone:14540?"),
        ("nonsense", "write udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT"),
        ("udpin:127.0.0.1:70000", "'70000' is no port; write a number from 1 to 65535"),
        ("tcp:127.0.0.1:five", "'five' is no port"),
        ("/dev/ttyACM0", "no baud rate; write /dev/ttyACM0,57600"),
        ("/dev/ttyACM0,fast", "'fast' is no baud rate"),
    ],
)
def test_a_wrong_device_is_answered_with_what_to_write(device: str, advice: str) -> None:
    with pytest.raises(UserError) as error:
        parse_device(device)
    assert advice in str(error.value)
    assert repr(device) in str(error.value)
    assert "\n" not in str(error.value)
