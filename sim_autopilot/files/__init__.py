"""Files and logs: MAVLink FTP, the log service and the log stream."""
