"""A companion that is built has loaded what messages need."""

import subprocess
import sys

FIRST_MESSAGES = """
import sys
from companion.config.companion import CompanionConfig
from companion.runtime.build import build_node
from link.messages import Fix, Plan
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.zenoh.keys import Keys

build_node(CompanionConfig(), Keys(), system_id=1, dry_run=True)
loaded = set(sys.modules)
cdr.encode(Plan(t_ns=1, poses=()))
try:
    cdr.decode(Fix, bytes(80))
except PayloadError:
    print(sorted(set(sys.modules) - loaded))
"""


def test_first_messages_of_a_flight_load_nothing() -> None:
    """Loading took 0.3 s, and on a small computer as long as PX4 waits for a setpoint."""
    ran = subprocess.run([sys.executable, "-c", FIRST_MESSAGES], check=True, capture_output=True, text=True)
    assert ran.stdout.strip() == "[]"
