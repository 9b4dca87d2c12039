"""A run in one process on a simulated clock: scored, and written into its folder."""

import time
from pathlib import Path

from companion.recording.folder import recording_sink
from link.program.toml_config import dump_toml
from link.recording.recorder import DirectRecorder
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.stopwatch import quantiles_ms, timed_steps
from scenarios.recordings.result import result_table, write_text
from scenarios.recordings.run_folder import Progress, RunOptions, RunOutcome, count_lost, write_outcome
from scenarios.recordings.truth_file import TruthFile


def run_in_lockstep(scenario: Scenario, options: RunOptions, progress: Progress) -> RunOutcome:
    """Run a scenario in this process on a simulated clock, score it on truth and write the run's folder."""
    write_text(options.folder / "scenario.toml", dump_toml(scenario))
    recorder = _direct_recorder(scenario, options.folder) if options.record else None
    truth = TruthFile(options.folder, scenario, options.seed, Keys()) if options.record else None
    lockstep = Lockstep(scenario, options.seed, recorder=recorder)
    with timed_steps() as durations_s:
        began_s = time.monotonic()
        ended = lockstep.run()
        factor = lockstep.recording.elapsed_s / (time.monotonic() - began_s)
    if recorder is not None:
        recorder.close()
    if truth is not None:
        truth.take(lockstep.recording)
        truth.close()
    progress(lockstep.recording, factor)
    result = result_table(scenario, options.seed, lockstep.recording, ended)
    step_ms = {name: quantiles_ms(durations) for name, durations in durations_s.items() if durations}
    timing = {"real_time_factor": round(factor, 4), "step_ms": step_ms}
    return write_outcome(options.folder, result, timing | count_lost(truth, recorder))


def _direct_recorder(scenario: Scenario, folder: Path) -> DirectRecorder:
    return DirectRecorder(recording_sink(folder, scenario.system.companion, Keys()))
