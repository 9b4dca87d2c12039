"""Bytes in and out of the process: UDP, TCP and serial ports, by the string that names them; not only for MAVLink."""
