"""The command line, one file per group of commands; `app.py` lists them.

Commands import what needs numpy inside their functions, so that `--help` and `--version` answer at
once.
"""
