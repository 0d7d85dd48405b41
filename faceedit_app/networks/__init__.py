"""Trained networks: their files, the character they are made for, answering in process."""
