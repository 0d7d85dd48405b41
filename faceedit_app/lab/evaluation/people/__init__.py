"""Figures on takes of real people: what users get, against simple references."""
