"""Attacks on the application: damaged files, random gestures, and kill -9."""
