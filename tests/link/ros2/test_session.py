"""A node beside plain Zenoh sessions that write out the design document's keys and bytes, over a real router."""

import struct
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
import zenoh
import zenoh.ext

from link.errors import UserError
from link.messages import CommandReply, Fix, PadGeometry
from link.payloads import cdr, json_messages
from link.payloads.checks import PayloadError
from link.ros2.attachment import publisher_id
from link.ros2.layout import open_layout
from link.ros2.options import Ros2Options, ros2_options
from link.ros2.ros_node import read_graph
from link.ros2.session import PadSource, Ros2Session, open_ros2_session
from link.ros2.topic_map import PadTopics
from link.zenoh.inbox import Inbox, WakeUp
from link.zenoh.keys import Keys
from link.zenoh.session import Sample, ZenohOptions, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.link.ros2.test_foreign import transform
from tests.link.ros_definitions import TFMessage
from tests.link.zenoh.waiting import until

DOMAIN = 3
KEYS = Keys(vehicle="car")
FIX_KEY = (
    f"{DOMAIN}/car/fix/sensor_msgs::msg::dds_::NavSatFix_/"
    "RIHS01_62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404"
)
START_KEY = (
    f"{DOMAIN}/drone/landing/start/std_srvs::srv::dds_::Trigger_/"
    "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
)
TF_KEY = (
    f"{DOMAIN}/tf_static/tf2_msgs::msg::dds_::TFMessage_/"
    "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
)
FIX = Fix(t_ns=1_700_000_000_000_000_123, latitude_rad=0.9, longitude_rad=0.2, altitude_m=40.0)
ENCODING = cdr.encoding_of(Fix)


@pytest.fixture
def endpoint() -> Iterator[str]:
    there = free_tcp_endpoint()
    with open_session(ZenohOptions(mode="router", listen=(there,))):
        yield there


@pytest.fixture
def bystander(endpoint: str) -> Iterator[zenoh.Session]:
    config = zenoh.Config.from_json5(
        f'{{mode: "client", connect: {{endpoints: ["{endpoint}"]}}, scouting: {{multicast: {{enabled: false}}}},'
        "timestamping: {enabled: true}}"
    )
    with zenoh.open(config) as session:
        yield session


def node(endpoint: str, map_file: Path | None = None) -> Ros2Session:
    options = ZenohOptions(mode="client", connect=(endpoint,))
    return open_ros2_session(options, Ros2Options(domain=DOMAIN, map_file=map_file), KEYS, ("/drone", "companion"))


def until_some(session: Ros2Session, found: list[zenoh.Sample], act: Callable[[], None]) -> None:
    def is_there() -> bool:
        act()
        return bool(found)

    until(session, is_there)


def test_samples_are_numbered_dated_and_signed_with_the_id_of_their_token(
    endpoint: str, bystander: zenoh.Session
) -> None:
    found: list[zenoh.Sample] = []
    held = bystander.declare_subscriber(FIX_KEY, found.append)
    with node(endpoint) as ours:
        began_ns = time.time_ns()
        until_some(ours, found, lambda: ours.publish(KEYS.fix, cdr.encode(FIX), ENCODING))
        replies = bystander.liveliness().get(f"@ros2_lv/{DOMAIN}/*/*/*/MP/**")
        tokens = [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]
    del held
    attachments = [sample.attachment.to_bytes() for sample in found if sample.attachment is not None]
    assert len(attachments) == len(found)
    numbers = [struct.unpack_from("<q", one)[0] for one in attachments]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert began_ns <= struct.unpack_from("<qq", attachments[0])[1] <= time.time_ns()
    (token,) = tokens
    assert attachments[0][16:] == b"\x10" + publisher_id(token)
    assert found[0].payload.to_bytes() == cdr.encode(FIX)


@pytest.mark.parametrize("attachment", [None, b"", b"\xff" * 33, b"sequence_number"])
def test_samples_are_heard_whatever_is_attached(
    endpoint: str, bystander: zenoh.Session, attachment: bytes | None
) -> None:
    with node(endpoint) as ours:
        inbox = ours.subscribe(KEYS.fix)
        samples: list[Sample] = []

        def has_come() -> bool:
            bystander.put(FIX_KEY, cdr.encode(FIX), attachment=attachment)
            samples.extend(inbox.take())
            return bool(samples)

        until(ours, has_come)
    assert (samples[0].key, samples[0].payload) == (KEYS.fix, cdr.encode(FIX))


def test_a_sample_that_is_larger_than_it_may_be_is_a_bad_one(endpoint: str, bystander: zenoh.Session) -> None:
    with node(endpoint) as ours:
        inbox = ours.subscribe(KEYS.fix, sample_bytes_max=len(cdr.encode(FIX)) - 1)
        samples: list[Sample] = []

        def has_come() -> bool:
            bystander.put(FIX_KEY, cdr.encode(FIX))
            samples.extend(inbox.take())
            return bool(samples)

        until(ours, has_come)
    with pytest.raises(PayloadError):
        cdr.decode(Fix, samples[0].payload)


def test_humble_has_no_hashes(endpoint: str, bystander: zenoh.Session, tmp_path: Path) -> None:
    map_file = tmp_path / "map.toml"
    map_file.write_text('distribution = "humble"\n', encoding="utf-8")
    found: list[zenoh.Sample] = []
    key = f"{DOMAIN}/car/fix/sensor_msgs::msg::dds_::NavSatFix_/TypeHashNotSupported"
    held = bystander.declare_subscriber(key, found.append)
    with node(endpoint, map_file) as ours:
        until_some(ours, found, lambda: ours.publish(KEYS.fix, cdr.encode(FIX), ENCODING))
        replies = bystander.liveliness().get(f"@ros2_lv/{DOMAIN}/*/*/*/MP/**")
        (token,) = [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]
    del held
    assert token.split("/")[-2] == "TypeHashNotSupported"


def test_vehicle_is_alive_while_its_publisher_has_a_token(endpoint: str, bystander: zenoh.Session) -> None:
    with node(endpoint) as ours:
        alive = ours.watch_alive(KEYS.alive)
        type_name, type_hash = FIX_KEY.split("/")[-2:]
        key = f"@ros2_lv/{DOMAIN}/{bystander.zid()}/0/1/MP/%/%/gnss/%car%fix/{type_name}/{type_hash}/::,5:,:,:,,"
        token = bystander.liveliness().declare_token(key)
        until(ours, lambda: alive.alive)
        token.undeclare()  # type: ignore[no-untyped-call]  # its stub has no return type
        until(ours, lambda: not alive.alive)


@pytest.mark.parametrize("publishes_first", [True, False])
def test_pad_comes_from_latched_transforms(
    endpoint: str, bystander: zenoh.Session, tmp_path: Path, publishes_first: bool
) -> None:
    map_file = tmp_path / "map.toml"
    map_file.write_text('[pad]\nsize_m = [1.2, 1.4]\nheight_m = 1.6\nantenna_frame = "gnss"\n', encoding="utf-8")
    told = TFMessage(
        [transform("base_link", "gnss", (0.3, 0.0, 1.9)), transform("base_link", "landing_pad", (1.0, 0.2, 1.6))]
    ).serialize()

    def publish() -> object:
        publisher = zenoh.ext.declare_advanced_publisher(
            bystander, TF_KEY, cache=zenoh.ext.CacheConfig(max_samples=1), publisher_detection=True
        )
        publisher.put(told)
        return publisher

    held = publish() if publishes_first else None
    with node(endpoint, map_file) as ours:
        held = held or publish()
        answers: list[PadGeometry] = []

        def has_answer() -> bool:
            inbox = ours.ask(KEYS.pad, b"", 1.0)
            answers.extend(json_messages.decode(PadGeometry, sample.payload) for sample in inbox.take())
            return bool(answers)

        until(ours, has_answer)
    del held
    assert answers[0].size_m == (1.2, 1.4)
    assert answers[0].antenna_to_pad_m == pytest.approx((0.7, 0.2, -0.3))


def test_transforms_of_no_vehicle_are_a_bad_answer_and_end_nothing() -> None:
    told = [transform("base_link", "gnss", (0.0, 0.0, 0.0)), transform("base_link", "landing_pad", (300.0, 0.0, 0.0))]
    with closing(WakeUp()) as wake_up:
        transforms = Inbox(capacity=1, wake_up=wake_up)
        source = PadSource(PadTopics(size_m=(1.2, 1.4), height_m=1.6, antenna_frame="gnss"), transforms)
        assert source.answer() is None
        transforms.put(Sample("tf_static", TFMessage(told).serialize(), 0))
        answer = source.answer()
    assert answer is not None
    with pytest.raises(PayloadError):
        json_messages.decode(PadGeometry, answer)


def test_command_is_a_trigger_service_that_answers_with_the_callers_number(
    endpoint: str, bystander: zenoh.Session
) -> None:
    asked: list[bytes] = []

    def take(payload: bytes, reply: Callable[[bytes], None]) -> None:
        asked.append(payload)
        reply(json_messages.encode(CommandReply(accepted=False, reason="no vehicle")))

    caller = struct.pack("<qqB", 41, 5, 16) + bytes(range(16))
    found: list[zenoh.Sample] = []
    with node(endpoint) as ours:
        ours.serve_later(KEYS.landing_command, take)

        def call() -> None:
            replies = bystander.get(
                START_KEY, payload=b"\0\1\0\0\0", attachment=caller, target=zenoh.QueryTarget.ALL_COMPLETE
            )
            found.extend(reply.ok for reply in replies if reply.ok is not None)

        until_some(ours, found, call)
    assert asked[0] == b'{"command":"start"}'
    assert found[0].payload.to_bytes() == b"\0\1\0\0" + b"\0\0\0\0" + b"\x0b\0\0\0no vehicle\0"
    assert found[0].attachment is not None
    reply = found[0].attachment.to_bytes()
    assert (reply[:8], reply[16:]) == (caller[:8], caller[16:])


def test_graph_is_read(endpoint: str) -> None:
    options = ZenohOptions(mode="client", connect=(endpoint,))
    with node(endpoint) as ours:
        ours.subscribe(KEYS.fix)
        tokens = read_graph(options, DOMAIN)
        assert not read_graph(options, DOMAIN + 1)
    assert {token.node for token in tokens} == {"companion"}
    assert [token.endpoint.name for token in tokens if token.endpoint is not None] == ["/car/fix"]


def test_mistakes_are_users_errors(endpoint: str) -> None:
    options = ZenohOptions(mode="client", connect=(endpoint,))
    with pytest.raises(UserError, match="0 to 232"):
        ros2_options(233, None)
    with pytest.raises(UserError, match="add --ros2"):
        ros2_options(None, Path("map.toml"))
    with pytest.raises(UserError, match="no ROS name"):
        open_layout(options, Ros2Options(domain=0), Keys(vehicle="my-car"), ("/drone", "companion"))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('[vehicle]\nodometry = "/a"\n', "belong together"),
        ('[vehicle]\nfix = "fix"\n', "vehicle.fix"),
        ("[pad]\nsize_m = [1.0, 1.0]\n", "pad.height_m"),
    ],
)
def test_mistake_in_the_map_names_file_and_key(endpoint: str, tmp_path: Path, text: str, told: str) -> None:
    map_file = tmp_path / "map.toml"
    map_file.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=told):
        node(endpoint, map_file)
