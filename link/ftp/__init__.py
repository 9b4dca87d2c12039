"""MAVLink FTP, a server without I/O, and the files behind it."""
