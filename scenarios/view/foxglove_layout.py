"""A layout of Foxglove for a landing: the scene, the map, plots of the contact, phases and the log."""

from typing import TYPE_CHECKING

from link.program.extras import require
from link.zenoh.keys import Keys

if TYPE_CHECKING:
    import foxglove.layouts as fl


def layout_json(keys: Keys) -> str:
    """Return the layout of one drone and vehicle, as Foxglove imports it.

    Raises:
        UserError: the library is not installed.
    """
    require("foxglove", "--foxglove-layout")
    import foxglove.layouts as fl  # noqa: PLC0415 (it is of an extra)

    scene, phases = _scene(_topic(keys, "scene")), _phases(_topic(keys, "step"))
    where = fl.MapPanel(title="Where", config=fl.MapConfig(follow_topic=_topic(keys, "location")))
    log = fl.LogPanel(title="Log", config=fl.LogConfig(topic_to_render=_topic(keys, "log")))
    left = fl.SplitContainer(
        direction="column", items=[fl.SplitItem(proportion=4, content=scene), fl.SplitItem(content=phases)]
    )
    panels = (*_contact(_topic(keys, "step")), _picture(keys), where, log)
    right = fl.SplitContainer(direction="column", items=[fl.SplitItem(content=panel) for panel in panels])
    content = fl.SplitContainer(
        direction="row", items=[fl.SplitItem(proportion=2, content=left), fl.SplitItem(content=right)]
    )
    return fl.Layout(content=content).to_json()


def _topic(keys: Keys, name: str) -> str:
    return f"/{keys.record(name)}"


def _scene(topic: str) -> "fl.ThreeDeePanel":
    import foxglove.layouts as fl  # noqa: PLC0415 (as above)

    return fl.ThreeDeePanel(
        title="Landing",
        config=fl.ThreeDeeConfig(
            follow_tf="vehicle",
            fixed_frame="map",
            follow_mode="follow-position",
            camera_state=fl.ThreeDeeCameraState(distance=12.0, phi=65.0, theta_offset=-40.0, perspective=True),
            topics={topic: fl.BaseRendererSceneUpdateTopicSettings(visible=True)},
            layers={"grid": fl.BaseRendererGridLayerSettings(visible=True, size=200.0, divisions=40.0)},
        ),
    )


def _phases(step: str) -> "fl.StateTransitionsPanel":
    import foxglove.layouts as fl  # noqa: PLC0415 (as above)

    return fl.StateTransitionsPanel(
        title="Phase",
        config=fl.StateTransitionsConfig(paths=[fl.StateTransitionsSeries(value=f"{step}.phase", label="phase")]),
    )


def _contact(step: str) -> "tuple[fl.PlotPanel, fl.PlotPanel]":
    """Return the plots of place and velocity against the pad."""
    height = _plot(
        "Over the pad, m",
        height=f"{step}.height_above_pad_m[0]",
        east=f"{step}.relative_position_m[0]",
        north=f"{step}.relative_position_m[1]",
    )
    speed = _plot(
        "Against the pad, m/s",
        east=f"{step}.relative_velocity_m_s[0]",
        north=f"{step}.relative_velocity_m_s[1]",
        up=f"{step}.relative_velocity_m_s[2]",
    )
    return height, speed


def _plot(title: str, **series: str) -> "fl.PlotPanel":
    import foxglove.layouts as fl  # noqa: PLC0415 (as above)

    paths = [fl.PlotSeries(value=value, label=label.replace("_", " ")) for label, value in series.items()]
    return fl.PlotPanel(title=title, config=fl.PlotConfig(paths=paths))


def _picture(keys: Keys) -> "fl.ImagePanel":
    import foxglove.layouts as fl  # noqa: PLC0415 (as above)

    image_mode = fl.ImageModeConfig(
        image_topic=f"/{keys.camera_compressed}",
        annotations={f"/{keys.pad_annotations}": fl.ImageAnnotationSettings(visible=True)},
        synchronize=True,
    )
    return fl.ImagePanel(title="What the detector sees", config=fl.ImageConfig(image_mode=image_mode))
