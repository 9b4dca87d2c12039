"""The layout of ROS 2's own Zenoh middleware, rmw_zenoh: names, hashes and attachments, and a session that speaks it.

After docs/design.md of ros2/rmw_zenoh (2025, Jazzy to Rolling).
"""
