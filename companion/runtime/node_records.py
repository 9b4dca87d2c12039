"""What a node's last step leaves for those who look at it from outside: a recorder or a view."""

from companion.recording.records import LinkRecord, StepRecord
from companion.runtime.node import CompanionNode


def step_record(node: CompanionNode, local_ns: int) -> StepRecord | None:
    """Return the step that was made at `local_ns`, None before the first one."""
    if node.inputs is None or node.outputs is None:
        return None
    clock = node.autopilot.session.clock
    return StepRecord(
        local_ns=local_ns,
        utc_known=clock.is_utc_known and clock.local_to_boot is not None,
        inputs=node.inputs,
        outputs=node.outputs,
        estimator=node.system.estimator,
        estimator_memory=node.memory.vehicle.estimator,
    )


def link_record(node: CompanionNode, t_ns: int, records_dropped: int) -> LinkRecord:
    """Return the counters of both links at `t_ns`."""
    return LinkRecord(
        t_ns=t_ns,
        session=node.autopilot.session.statistics,
        zenoh_bad_payloads=node.bad_payloads,
        records_dropped=records_dropped,
    )
