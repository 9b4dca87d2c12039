"""The node in bytes: what it sends to a PX4, and what no peer can make it do."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.autopilots.response import ResponseModel
from companion.config.autopilot import AutopilotConfig
from companion.config.companion import CompanionConfig
from companion.situation.phases import Phase
from link.errors import UserError
from link.mavlink.dialect import Message, mavlink
from link.messages import Command, Fix, FixVelocity, LandingStatus, PadGeometry, PadSighting, Plan, VehicleImu
from link.payloads import cdr, json_messages
from link.records import replace
from tests.companion.facts import changed
from tests.companion.peer import KEYS, OFFBOARD, POSITION, FakePx4, Setup
from tests.companion.runtime.setups import flying, ready
from tests.link.mavlink.fake_autopilot import S

ARM, SET_MODE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE


@pytest.mark.parametrize(("phase", "counts"), [(Phase.CHASE, True), (Phase.DESCEND, False), (Phase.TOUCHDOWN, False)])
def test_limits_that_change_in_a_descent_count_after_it(phase: Phase, *, counts: bool) -> None:
    setup = ready()
    node, before = setup.node, setup.node.inputs
    assert before is not None
    node.memory = replace(node.memory, progress=replace(node.memory.progress, phase=phase))
    state = node.autopilot.state
    node.autopilot.state = replace(state, parameters={**state.parameters, "MPC_XY_VEL_MAX": 3.0})
    while node.inputs is before:
        setup.t_ns += 1_000_000
        node.poll(setup.t_ns)
    assert node.inputs is not None
    assert (node.inputs.limits.speed_max_m_s == 3.0) is counts


@pytest.mark.slow
def test_node_arms_changes_mode_and_streams_only_after_a_start() -> None:
    setup = ready()
    setup.run(3.0, setup.fixes)
    for command in (ARM, SET_MODE):
        assert not setup.autopilot.commands(command)
    assert not setup.autopilot.setpoints()
    setup.node.request(Command.START)
    setup.run(3.0)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]
    assert setup.autopilot.armed
    assert setup.autopilot.custom_mode == OFFBOARD


@pytest.mark.slow
def test_setpoints_come_at_the_step_rate_and_in_the_autopilots_time() -> None:
    setup = flying()
    before = len(setup.autopilot.setpoints())
    setup.run(2.0)
    setpoints = setup.autopilot.setpoints()[before:]
    assert 95 <= len(setpoints) <= 135
    boot_ms = setup.autopilot.boot_ns(setup.t_ns) / 1e6
    assert abs(setpoints[-1].time_boot_ms - boot_ms) < 60.0
    times = [message.time_boot_ms for message in setpoints]
    assert times == sorted(times)


@pytest.mark.slow
def test_pilots_mode_change_silences_the_node() -> None:
    setup = flying()
    setup.autopilot.custom_mode = POSITION
    setup.run(0.1)  # CURRENT_MODE comes at 20 Hz
    assert setup.node.phase is Phase.PILOT
    setpoints, modes = len(setup.autopilot.setpoints()), len(setup.autopilot.commands(SET_MODE))
    setup.run(5.0)
    assert len(setup.autopilot.setpoints()) == setpoints
    assert len(setup.autopilot.commands(SET_MODE)) == modes


@pytest.mark.slow
def test_dry_run_sends_neither_setpoints_nor_commands_that_fly() -> None:
    setup = Setup(dry_run=True)
    setup.run(3.0)
    setup.node.request(Command.START)
    setup.run(3.0)
    assert setup.node.phase is Phase.TAKEOFF
    assert not setup.autopilot.setpoints()
    assert not setup.autopilot.commands(SET_MODE)
    assert not setup.autopilot.commands(ARM)


def test_vehicle_that_is_no_multirotor_is_refused_by_name() -> None:
    setup = Setup(autopilot=FakePx4(vehicle_type=mavlink.MAV_TYPE_FIXED_WING))
    with pytest.raises(UserError, match="no multirotor"):
        setup.run(2.0)


@pytest.mark.slow
def test_response_of_the_autopilot_is_made_anew_when_a_gain_changes_and_only_then() -> None:
    setup = Setup(autopilot=FakePx4(parameters={"MPC_XY_P": (0.8, mavlink.MAV_PARAM_TYPE_REAL32)}))
    setup.run(8.0)
    before = _response(setup)
    setup.run(1.0)
    assert _response(setup) is before
    assert before.cascade.position_per_s == pytest.approx(0.8)
    setup.autopilot.parameters["MPC_XY_P"] = (1.3, mavlink.MAV_PARAM_TYPE_REAL32)
    setup.autopilot.tell_parameter("MPC_XY_P")
    setup.run(0.5)
    assert _response(setup).cascade.position_per_s == pytest.approx(1.3)


def _response(setup: Setup) -> ResponseModel:
    assert setup.node.inputs is not None
    assert setup.node.inputs.response is not None
    return setup.node.inputs.response


@pytest.mark.slow
def test_local_frame_that_moves_in_flight_is_flown_on_in() -> None:
    setup = flying()
    setup.autopilot.place_ned_m = (0.0, 0.0, -5.12)
    setup.run(5.0)
    asked = len(setup.autopilot.commands(mavlink.MAV_CMD_REQUEST_MESSAGE))
    target = setup.autopilot.setpoints()[-1]
    setup.autopilot.place_ned_m = (40.0, -25.0, -5.12)
    setup.run(0.2)
    moved = setup.autopilot.setpoints()[-1]
    assert moved.x - target.x == pytest.approx(40.0, abs=0.05)
    assert moved.y - target.y == pytest.approx(-25.0, abs=0.05)
    assert len(setup.autopilot.commands(mavlink.MAV_CMD_REQUEST_MESSAGE)) > asked


@pytest.mark.slow
def test_status_and_plan_are_published_and_can_be_read() -> None:
    setup = flying()
    setup.node.take_publications()
    setup.run(1.0)
    published = setup.node.take_publications()
    statuses = [one for one in published if one.key == KEYS.landing_status]
    plans = [one for one in published if one.key == KEYS.landing_plan]
    assert 8 <= len(statuses) <= 12
    status = json_messages.decode(LandingStatus, statuses[-1].payload)
    assert status.phase == "takeoff"
    assert abs(status.stamp_ns - setup.utc_ns) < S
    assert len(cdr.decode(Plan, plans[-1].payload).poses) > 3


def test_node_that_nobody_listens_to_says_the_same_to_its_autopilot() -> None:
    said: list[list[bytes]] = []
    for publishes in (True, False):
        setup = Setup(publishes=publishes)
        setup.run(3.0)
        setup.node.request(Command.START)
        setup.run(1.0)
        assert bool(setup.node.take_publications()) is publishes
        said.append([bytes(message.get_msgbuf()) for message in setup.autopilot.received])
    assert said[0] == said[1]
    assert len(said[0]) > 100


@pytest.mark.slow
def test_pilot_reads_every_phase() -> None:
    setup = flying()
    texts = [message.text for message in setup.autopilot.of_type("STATUSTEXT")]
    assert any("takeoff" in text for text in texts)


def test_bad_payloads_are_counted_and_change_nothing() -> None:
    setup = ready()
    for key in (KEYS.fix, KEYS.fix_velocity, KEYS.imu, KEYS.pad_pose):
        setup.node.receive_sample(key, b"\x00\x01\x00\x00nonsense")
    setup.run(0.1)
    assert setup.node.bad_payloads == 4
    assert setup.node.memory.vehicle.estimator is None


def test_pad_that_no_vehicle_has_is_counted_and_not_taken() -> None:
    setup = Setup()
    for lever in ((51.0, 0.0, 0.0), (0.0, math.nan, 0.0)):
        setup.node.receive_pad(PadGeometry(size_m=(1.0, 1.0), height_m=1.5, antenna_to_pad_m=lever))
    assert not setup.node.vehicle.knows_pad
    assert setup.node.bad_payloads == 2


def test_second_description_of_the_same_ship_costs_no_estimate() -> None:
    setup = ready()
    ship = PadGeometry(size_m=(8.0, 8.0), height_m=6.0, antenna_to_pad_m=(0.0, 0.0, 0.0), is_afloat=True)
    setup.node.receive_pad(ship)
    setup.fix()
    setup.run(0.1)
    assert setup.node.memory.vehicle.estimator is not None
    setup.node.receive_pad(replace(ship))
    assert setup.node.memory.vehicle.estimator is not None
    setup.node.receive_pad(replace(ship, is_afloat=False))
    assert setup.node.memory.vehicle.estimator is None


@pytest.mark.slow
def test_geoid_lifts_the_origin_to_the_ellipsoid() -> None:
    setup = Setup(autopilot=FakePx4(geoid_height_m=47.3))
    setup.run(4.0)
    frame = setup.node.autopilot.state.view.frame
    assert frame is not None
    assert frame.origin.altitude_m == pytest.approx(setup.autopilot.origin_altitude_m + 47.3, abs=1e-3)


@pytest.mark.slow
def test_autopilot_that_tells_no_height_above_the_ellipsoid_is_not_started_and_says_what_to_set() -> None:
    setup = Setup(autopilot=FakePx4(geoid_height_m=None))
    setup.run(5.0, setup.fixes)
    setup.node.request(Command.START)
    setup.run(0.1, setup.fixes)
    (reply,) = setup.node.take_replies()
    assert not reply.accepted
    assert "set autopilot.geoid_height_m" in reply.reason
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason == reply.reason
    assert not setup.node.is_ready_to_start()


@pytest.mark.slow
def test_geoid_of_the_configuration_counts_where_the_autopilot_tells_none() -> None:
    config = CompanionConfig(autopilot=AutopilotConfig(geoid_height_m=47.3))
    for told_m, taken_m in ((None, 47.3), (-30.0, -30.0)):
        setup = Setup(autopilot=FakePx4(geoid_height_m=told_m), config=config)
        setup.run(2.0)
        frame = setup.node.autopilot.state.view.frame
        assert frame is not None
        assert frame.origin.altitude_m == pytest.approx(setup.autopilot.origin_altitude_m + taken_m, abs=1e-3)
        assert setup.node.is_ready_to_start()


finite = st.floats(allow_nan=False, allow_infinity=False)
any_float = st.one_of(finite, st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e38, 0.0]))
three = st.tuples(any_float, any_float, any_float)
variance = st.sampled_from([0.0, 1e-30, 1e-6, 0.3, 1e6, 1e30, 1e300])
stamps = st.integers(-3 * S, 3 * S)


def _diagonal(value: float) -> tuple[float, float, float, float, float, float, float, float, float]:
    return (value, 0.0, 0.0, 0.0, value, 0.0, 0.0, 0.0, value)


@st.composite
def vehicle_samples(draw: st.DrawFn) -> tuple[str, Fix | FixVelocity | VehicleImu | PadSighting]:
    t_ns = draw(stamps)
    covariance = _diagonal(draw(variance))
    match draw(st.integers(0, 3)):
        case 0:
            place = (draw(st.floats(-1.5, 1.5)), draw(st.floats(-3.1, 3.1)), draw(any_float))
            latitude, longitude, altitude = place
            fix = Fix(t_ns=t_ns, latitude_rad=latitude, longitude_rad=longitude, altitude_m=altitude)
            return KEYS.fix, replace(fix, covariance_enu_m2=covariance)
        case 1:
            rate = draw(st.one_of(st.none(), any_float))
            return KEYS.fix_velocity, FixVelocity(
                t_ns=t_ns,
                velocity_enu_m_s=draw(three),
                velocity_covariance_enu_m2_s2=covariance,
                yaw_rate_rad_s=rate,
                yaw_rate_variance_rad2_s2=draw(variance),
            )
        case 2:
            return KEYS.imu, VehicleImu(
                t_ns=t_ns,
                orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
                orientation_covariance_rad2=covariance,
                angular_velocity_flu_rad_s=draw(three),
            )
        case _:
            return KEYS.pad_pose, PadSighting(
                t_ns=t_ns,
                position_flu_m=draw(three),
                orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
                position_covariance_m2=covariance,
            )


def _is_sound(message: Message) -> bool:
    values = (message.x, message.y, message.z, message.vx, message.vy, message.vz)
    return all(map(math.isfinite, (*values, message.afx, message.afy, message.afz, message.yaw)))


@pytest.mark.slow
@given(samples=st.lists(vehicle_samples(), max_size=12), lever=st.tuples(any_float, any_float, any_float))
@settings(max_examples=12, deadline=None)
def test_nothing_a_vehicle_says_makes_a_setpoint_absurd(
    samples: list[tuple[str, Fix | FixVelocity | VehicleImu | PadSighting]], lever: tuple[float, float, float]
) -> None:
    setup = flying()
    setup.node.receive_pad(PadGeometry(size_m=(1.0, 1.0), height_m=1.5, antenna_to_pad_m=lever))
    setup.fix()
    setup.node.memory = changed(setup.node.memory, phase=Phase.CHASE)  # where the pad is followed
    for key, message in samples:
        stamped = replace(message, t_ns=setup.utc_ns + message.t_ns)
        try:
            payload = cdr.encode(stamped)
        except cdr.PayloadError:
            continue
        setup.node.receive_sample(key, payload)
        setup.run(0.06)
    setup.run(0.5)
    assert all(_is_sound(message) for message in setup.autopilot.setpoints())
    assert setup.node.autopilot.setpoints.bad == 0
    assert abs(setup.autopilot.setpoints()[-1].x) < 1e3
