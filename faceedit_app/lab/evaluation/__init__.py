"""Measuring the networks and the edits: metrics, benchmark, the paper's experiments."""
