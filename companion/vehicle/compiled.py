"""How the estimators' compiled functions are kept on disk: made anew when any file that holds some of them changes."""

from pathlib import Path

from link.compiled import file_digest, kept_kernel

FILES = (
    "angle.py",
    "lever.py",
    "shake.py",
    "small_matrices.py",
    "imm_swing.py",
    "imm_kernels.py",
    "imm_noise.py",
    "imm_sensors.py",
    "imm_mixing.py",
    "imm_judgement.py",
    "imm_forecast.py",
    "ukf_motion.py",
)
"""All that compiled functions of this package are in: they call each other across them."""

compiled_kernel = kept_kernel(file_digest(Path(__file__).with_name(name) for name in FILES))
