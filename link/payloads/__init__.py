"""What travels over Zenoh and into recordings, as bytes: ROS 2 messages in CDR, and JSON."""
