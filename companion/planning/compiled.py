"""How the planners' compiled functions are kept on disk: made anew when any file that holds some of them changes."""

from pathlib import Path

from link.compiled import file_digest, kept_kernel

FILES = (
    "axis_qp.py",
    "descent_path.py",
    "envelope.py",
    "horizon.py",
    "intercept.py",
    "programmes.py",
    "qp.py",
    "resample.py",
)
"""All that compiled functions of this package are in: they call each other across them."""

compiled_kernel = kept_kernel(file_digest(Path(__file__).with_name(name) for name in FILES))
