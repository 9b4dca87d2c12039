"""A vehicle of ROS 2 for a landing: it knows docs/design.md of ros2/rmw_zenoh and nothing of `link`.

It takes the simulated car's truth for what its own localization knows, and says what Autoware's would: an odometry on
`/localization/kinematic_state`, and once, latched, where its pad is. Keys, tokens and attachments are written out here.

Its localization errs as its covariances say, by a draw of SEED.

    python -m tests.integration.ros_vehicle ENDPOINT SEED
"""

import json
import math
import random
import struct
import sys
import threading
import time

import zenoh
import zenoh.ext

from tests.link.ros_definitions import (
    Header,
    Odometry,
    Quaternion,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Vector3,
)

TRUTH = "decklander/vehicle/truth"
DOMAIN = 7
STATE_TYPE = "nav_msgs::msg::dds_::Odometry_/RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
TF_TYPE = "tf2_msgs::msg::dds_::TFMessage_/RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
PUBLISHER_ID = bytes(range(16))
PERIOD = 5
"""Every so many truths, which come at 100 Hz."""

POSITION_VARIANCE_M2, ATTITUDE_VARIANCE_RAD2 = 0.02**2, 0.01**2
VELOCITY_VARIANCE_M2_S2, RATE_VARIANCE_RAD2_S2 = 0.05**2, 0.01**2
PAD_IN_BODY_M = (0.0, 0.0, 1.5)


def diagonal(first: float, second: float) -> list[float]:
    """Return a row-major 6x6 with three variances of each."""
    return [(first if i < 3 else second) if i == j else 0.0 for i in range(6) for j in range(6)]


def err(told: Odometry, draw: random.Random) -> None:
    """Draw the errors of a localization that is as good as its covariances."""
    place, velocity = told.pose.pose.position, told.twist.twist.linear
    for vector, variance in ((place, POSITION_VARIANCE_M2), (velocity, VELOCITY_VARIANCE_M2_S2)):
        vector.x += draw.gauss(0.0, math.sqrt(variance))
        vector.y += draw.gauss(0.0, math.sqrt(variance))
        vector.z += draw.gauss(0.0, math.sqrt(variance))
    told.twist.twist.angular.z += draw.gauss(0.0, math.sqrt(RATE_VARIANCE_RAD2_S2))
    turn, half_rad = told.pose.pose.orientation, 0.5 * draw.gauss(0.0, math.sqrt(ATTITUDE_VARIANCE_RAD2))
    w, x, y, z = turn.w, turn.x, turn.y, turn.z  # times a turn about the vertical
    turn.w, turn.z = w * math.cos(half_rad) - z * math.sin(half_rad), z * math.cos(half_rad) + w * math.sin(half_rad)
    turn.x, turn.y = x * math.cos(half_rad) + y * math.sin(half_rad), y * math.cos(half_rad) - x * math.sin(half_rad)


def attachment(sequence: int) -> bytes:
    return struct.pack("<qq", sequence, time.time_ns()) + b"\x10" + PUBLISHER_ID


def main() -> None:
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([sys.argv[1]]))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")  # as rmw_zenoh's own session configuration has it
    with zenoh.open(config) as session:
        base = f"@ros2_lv/{DOMAIN}/{session.zid()}/0"
        state = session.declare_publisher(f"{DOMAIN}/localization/kinematic_state/{STATE_TYPE}")
        transforms = zenoh.ext.declare_advanced_publisher(
            session,
            f"{DOMAIN}/tf_static/{TF_TYPE}",
            cache=zenoh.ext.CacheConfig(max_samples=1),
            publisher_detection=True,
        )
        tokens = [
            session.liveliness().declare_token(key)
            for key in (
                f"{base}/0/NN/%/%localization/ekf_localizer",
                f"{base}/1/MP/%/%localization/ekf_localizer/%localization%kinematic_state/{STATE_TYPE}/::,1:,:,:,,",
                f"{base}/2/MP/%/%localization/ekf_localizer/%tf_static/{TF_TYPE}/:1:,1:,:,:,,",
            )
        ]
        header = Header(Time(0, 0), "base_link")
        there = Transform(Vector3(*PAD_IN_BODY_M), Quaternion(0.0, 0.0, 0.0, 1.0))
        transforms.put(
            TFMessage([TransformStamped(header, "landing_pad", there)]).serialize(), attachment=attachment(1)
        )
        heard, draw = 0, random.Random(int(sys.argv[2]))

        def relay(sample: zenoh.Sample) -> None:
            nonlocal heard
            heard += 1
            if heard % PERIOD:
                return
            told = Odometry.deserialize(sample.payload.to_bytes())
            err(told, draw)
            told.pose.covariance = diagonal(POSITION_VARIANCE_M2, ATTITUDE_VARIANCE_RAD2)
            told.twist.covariance = diagonal(VELOCITY_VARIANCE_M2_S2, RATE_VARIANCE_RAD2_S2)
            state.put(told.serialize(), attachment=attachment(heard // PERIOD))

        held = (tokens, session.declare_subscriber(TRUTH, relay))
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        threading.Event().wait()
        del held


if __name__ == "__main__":
    main()
