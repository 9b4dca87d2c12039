"""The modes, what leads from each to which, and what each wants flown."""
