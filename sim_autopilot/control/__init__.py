"""Flight controllers: from setpoints to rotor commands."""
