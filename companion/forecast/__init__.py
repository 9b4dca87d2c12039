"""How the contact will be if a descent goes on: its distribution, from what is known and how this vehicle drives."""
