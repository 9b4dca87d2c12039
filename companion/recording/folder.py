"""A companion's recording in a folder, with all that is needed to replay it."""

from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import machine, python_version

from companion.config.companion import CompanionConfig
from companion.recording.sink import CompanionSink
from link.program.toml_config import dump_toml
from link.recording.mcap_writer import McapRecording, RecordingSpec
from link.zenoh.keys import Keys

STEM = "companion"
CONFIG_NAME = "companion.toml"
_BYTES_PER_MB = 1_000_000


def recording_sink(folder: Path, config: CompanionConfig, keys: Keys) -> CompanionSink:
    """Return where a companion's records go: into `recording_store` alone.

    Args:
        folder: made when it is missing.
        config: the companion's own, kept in the recording.
        keys: of the Zenoh contract.

    Raises:
        UserError: the folder cannot be written.
    """
    return CompanionSink(recording_store(folder, config, keys), keys, config.descent)


def recording_store(
    folder: Path, config: CompanionConfig, keys: Keys, *, system_id: int = 1, dry_run: bool = False
) -> McapRecording:
    """Return a recording of a companion: `<folder>/companion_000.mcap` and on.

    Args:
        folder: made when it is missing.
        config: the companion's own, kept in the recording.
        keys: of the Zenoh contract.
        system_id: MAVLink's.
        dry_run: whether the companion sends nothing.

    Raises:
        UserError: the folder cannot be written.
    """
    metadata = {
        "namespace": keys.namespace,
        "vehicle": keys.vehicle,
        "drone": keys.drone,
        "system_id": str(system_id),
        "dry_run": str(dry_run).lower(),
        "python": python_version(),
        "machine": machine(),
        **{f"version of {name}": _version(name) for name in ("decklander", "numpy", "numba", "daqp", "pymavlink")},
    }
    spec = RecordingSpec(
        folder=folder,
        stem=STEM,
        metadata=metadata,
        attachments={CONFIG_NAME: dump_toml(config)},
        file_max_bytes=round(config.recording.file_max_mb * _BYTES_PER_MB),
        total_max_bytes=round(config.recording.total_max_mb * _BYTES_PER_MB),
    )
    return McapRecording(spec)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
