"""How the contact will be if the descent goes on, and a drone that is level for it."""
