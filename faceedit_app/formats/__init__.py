"""The formats of takes: one module for each, and what they share."""
