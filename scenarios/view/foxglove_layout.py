"""A layout of Foxglove for a landing: the scene, the map, plots of the contact, phases and the log."""

from link.program.extras import require
from link.zenoh.keys import Keys


def layout_json(keys: Keys) -> str:
    """Return the layout of one drone and vehicle, as Foxglove imports it.

    Raises:
        UserError: the library is not installed.
    """
    require("foxglove", "--foxglove-layout")
    import foxglove.layouts as fl  # noqa: PLC0415 (it is of an extra)

    def topic(name: str) -> str:
        return f"/{keys.record(name)}"

    def plot(title: str, **series: str) -> fl.PlotPanel:
        paths = [fl.PlotSeries(value=value, label=label.replace("_", " ")) for label, value in series.items()]
        return fl.PlotPanel(title=title, config=fl.PlotConfig(paths=paths))

    scene = fl.ThreeDeePanel(
        title="Landing",
        config=fl.ThreeDeeConfig(
            follow_tf="vehicle",
            fixed_frame="map",
            follow_mode="follow-position",
            camera_state=fl.ThreeDeeCameraState(distance=12.0, phi=65.0, theta_offset=-40.0, perspective=True),
            topics={topic("scene"): fl.BaseRendererSceneUpdateTopicSettings(visible=True)},
            layers={"grid": fl.BaseRendererGridLayerSettings(visible=True, size=200.0, divisions=40.0)},
        ),
    )
    phases = fl.StateTransitionsPanel(
        title="Phase",
        config=fl.StateTransitionsConfig(
            paths=[fl.StateTransitionsSeries(value=f"{topic('step')}.phase", label="phase")]
        ),
    )
    height = plot(
        "Over the pad, m",
        height=f"{topic('step')}.height_above_pad_m[0]",
        east=f"{topic('step')}.relative_position_m[0]",
        north=f"{topic('step')}.relative_position_m[1]",
    )
    speed = plot(
        "Against the pad, m/s",
        east=f"{topic('step')}.relative_velocity_m_s[0]",
        north=f"{topic('step')}.relative_velocity_m_s[1]",
        up=f"{topic('step')}.relative_velocity_m_s[2]",
    )
    image_mode = fl.ImageModeConfig(
        image_topic=f"/{keys.camera_compressed}",
        annotations={f"/{keys.pad_annotations}": fl.ImageAnnotationSettings(visible=True)},
        synchronize=True,
    )
    seen = fl.ImagePanel(title="What the detector sees", config=fl.ImageConfig(image_mode=image_mode))
    where = fl.MapPanel(title="Where", config=fl.MapConfig(follow_topic=topic("location")))
    log = fl.LogPanel(title="Log", config=fl.LogConfig(topic_to_render=topic("log")))
    left = fl.SplitContainer(
        direction="column", items=[fl.SplitItem(proportion=4, content=scene), fl.SplitItem(content=phases)]
    )
    right = fl.SplitContainer(
        direction="column", items=[fl.SplitItem(content=panel) for panel in (height, speed, seen, where, log)]
    )
    content = fl.SplitContainer(
        direction="row", items=[fl.SplitItem(proportion=2, content=left), fl.SplitItem(content=right)]
    )
    return fl.Layout(content=content).to_json()
