"""Do the same to many takes: fixes, presets or edits, and another format.

Each take is a task that any process, here or on another computer, can do by itself (`tasks.py`).
Its outcome is one line of a log in the output folder (`log.py`), so that a run that was stopped
goes on where it was, and nothing is done twice.
"""
