"""What goes wrong on purpose: the fault matrix, and frames that no autopilot should mind."""
