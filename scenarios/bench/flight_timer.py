"""Flies landings on demand and tells what each took, as a line of JSON for each seed read: `flight_timer.py NAME`.

It is run by its path on the sources that PYTHONPATH names, those of another checkout, so it uses nothing of its own
package. The digest is of where the drone was throughout: equal ones are the same flight to the last bit.
"""

import hashlib
import json
import sys
import time

from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.warm_up import warm_process


def main() -> None:
    """Fly the scenario with each seed that standard input brings."""
    warm_process()
    for line in sys.stdin:
        run = Lockstep(load_scenario(sys.argv[1]), int(line))
        began_s = time.process_time()
        run.run()
        cpu_s = time.process_time() - began_s
        digest = hashlib.sha256(repr([(one.t_ns, one.position_enu_m) for one in run.recording.drone]).encode())
        found = {"cpu_s": cpu_s, "simulated_s": run.recording.elapsed_s, "digest": digest.hexdigest()}
        sys.stdout.write(f"{json.dumps(found)}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
