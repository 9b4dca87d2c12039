"""How the forecast's compiled functions are kept on disk: made anew when any file that holds some of them changes."""

from pathlib import Path

from link.compiled import file_digest, kept_kernel

FILES = ("knowledge.py", "rollout.py", "samples.py", "steering.py")
"""All that compiled functions of this package are in."""

compiled_kernel = kept_kernel(file_digest(Path(__file__).with_name(name) for name in FILES))
