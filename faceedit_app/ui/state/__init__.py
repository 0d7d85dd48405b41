"""What all views share: the open take, the time axis, tools, preferences, background work."""
