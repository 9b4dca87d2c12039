"""An open session in our own layout, or in that of ROS 2."""

from link.ros2.options import Ros2Options
from link.zenoh.keys import Keys
from link.zenoh.options import ZenohOptions
from link.zenoh.session import ZenohSession, open_session


def open_layout(options: ZenohOptions, ros2: Ros2Options | None, keys: Keys, node: tuple[str, str]) -> ZenohSession:
    """Return an open session in our own layout, or with `ros2` as the node of that namespace and name.

    Raises:
        UserError: A file, a name or an endpoint is wrong (see `open_session`).
    """
    if ros2 is None:
        return open_session(options)
    from link.ros2.session import open_ros2_session  # noqa: PLC0415 (it loads the types of ROS)

    return open_ros2_session(options, ros2, keys, node)
