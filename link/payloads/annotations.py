"""What is drawn on a picture, as `foxglove_msgs/ImageAnnotations`: closed lines through pixels, and a text."""

from collections.abc import Sequence

from link.payloads.decklander_msgs import RosMessage, typestore
from link.payloads.foxglove_msgs import PACKAGE
from link.payloads.ros_fields import to_time
from link.payloads.scene_parts import Color, make_color, make_message

Pixel = tuple[float, float]

_HALF_PX = 0.5  # Foxglove counts from the first pixel's corner, we from its middle
_THICK_PX, _FONT_PX = 2.0, 22.0
_NO_COLOR: Color = (0.0, 0.0, 0.0, 0.0)
_SHADE: Color = (0.0, 0.0, 0.0, 0.6)
_LINE_LOOP = 2


def annotations_message(
    topic: str, t_ns: int, outlines: Sequence[tuple[Sequence[Pixel], Color]], label: tuple[Pixel, str, Color]
) -> RosMessage:
    """Return the drawing on the picture of `t_ns`.

    Args:
        topic: without the leading slash.
        t_ns: the picture's own stamp, by which the two are put together.
        outlines: pixels (column, row) of each closed line, with its color.
        label: where a text begins, the text, and its color.
    """
    stamp = to_time(max(t_ns, 0))
    points = [
        make_message(
            "PointsAnnotation",
            timestamp=stamp,
            type=_LINE_LOOP,
            points=[_point(pixel) for pixel in pixels],
            outline_color=make_color(color),
            outline_colors=[],
            fill_color=make_color(_NO_COLOR),
            thickness=_THICK_PX,
            metadata=[],
        )
        for pixels, color in outlines
    ]
    place, text, color = label
    texts = [
        make_message(
            "TextAnnotation",
            timestamp=stamp,
            position=_point(place),
            text=text,
            font_size=_FONT_PX,
            text_color=make_color(color),
            background_color=make_color(_SHADE),
            metadata=[],
        )
    ]
    name = f"{PACKAGE}/ImageAnnotations"
    message = make_message("ImageAnnotations", timestamp=stamp, circles=[], points=points, texts=texts, metadata=[])
    return RosMessage(
        topic=topic, type_name=name, payload=bytes(typestore().serialize_cdr(message, name, little_endian=True))
    )


def _point(pixel: Pixel) -> object:
    return make_message("Point2", x=pixel[0] + _HALF_PX, y=pixel[1] + _HALF_PX)
