"""The equations as the modules that compute them state them, in the order in which a landing needs them."""

import textwrap
from importlib import import_module

from scenarios.manual.markdown import page

SECTIONS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    (
        "Where the vehicle is",
        "The vehicle's samples count at the time they were taken. `estimator.kind` chooses the filter.",
        (
            "companion.vehicle.estimator",
            "companion.vehicle.filter_step",
            "companion.vehicle.imm",
            "companion.vehicle.imm_kernels",
            "companion.vehicle.imm_noise",
            "companion.vehicle.imm_mixing",
            "companion.vehicle.lkf",
            "companion.vehicle.ukf",
            "companion.vehicle.ukf_motion",
            "companion.vehicle.pad",
        ),
    ),
    (
        "How the drone gets there",
        "A point mass is moved inside the limits, and the drone follows it. `guidance.kind` chooses the law.",
        (
            "companion.planning.mpc",
            "companion.planning.axis_qp",
            "companion.planning.horizon",
            "companion.planning.intercept",
            "companion.planning.envelope",
            "companion.planning.qp",
            "companion.planning.mpc_report",
            "companion.planning.pn",
            "companion.landing.steering.virtual_model",
            "companion.landing.steering.targets",
        ),
    ),
    (
        "When it has landed",
        "The autopilot's own land detector is made for the ground.",
        ("companion.landing.decisions.contact",),
    ),
    (
        "How the simulated drone flies",
        "Physics at 1 kHz. A real drone has its own.",
        (
            "sim_autopilot.physics.dynamics",
            "sim_autopilot.physics.airframe",
            "sim_autopilot.physics.rotors",
            "sim_autopilot.physics.step",
            "sim_autopilot.physics.contact",
            "sim_autopilot.physics.ground_effect",
            "sim_autopilot.air.wind",
        ),
    ),
    (
        "How the simulated drone is controlled",
        "`drone.controller` chooses the controller.",
        (
            "sim_autopilot.control.outer_loop",
            "sim_autopilot.control.geometric",
            "sim_autopilot.control.command",
            "sim_autopilot.control.lqr",
        ),
    ),
    (
        "What the simulated sensors see",
        "Each sample has noise, delay, jitter and loss of the scenario, and the stamp of when it was taken.",
        ("scenarios.simulation.noise", "scenarios.simulation.sensors"),
    ),
)
"""Sections: title, what they have in common, and the modules."""

TEXT = """Each section below is what the module of that name says of itself: its model, state, units and source.
World W is east, north, up; bodies B (drone) and V (vehicle) are forward, left, up; `p_WB` is the position of B from W,
in W; quaternions are Hamilton's, w first; a prime or a `d` before a name is a rate. The numbers are in the reference
of the configuration ([companion](reference/companion.md), [sim-autopilot](reference/sim_autopilot.md))."""


def equations_page() -> str:
    """Return the page of all equations."""
    parts = [TEXT]
    for title, text, modules in SECTIONS:
        parts += [f"## {title}", text, *(_of_module(name) for name in modules)]
    return page("Equations", *parts)


def _of_module(name: str) -> str:
    text = (import_module(name).__doc__ or "").strip()
    return f"### `{name}`\n\n{_as_markdown(text)}"


def _as_markdown(text: str) -> str:
    """Return a docstring with its indented lists as literal blocks; one after a sentence needs a line between."""
    parts: list[str] = []
    for line in text.splitlines():
        literal = line.startswith("  ")
        if parts and line and literal != parts[-1].startswith("    ") and parts[-1]:
            parts.append("")
        parts.append(textwrap.indent(line, "  ") if literal else line)
    return "\n".join(parts)
