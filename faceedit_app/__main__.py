"""`python -m faceedit_app` is `faceedit`."""

import sys

from faceedit_app.cli import main

sys.exit(main())
