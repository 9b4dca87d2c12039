"""MAVLink FTP and the files behind it."""
