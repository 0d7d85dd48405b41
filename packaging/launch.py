"""What the bundled application starts with; a pip install has its own `faceedit` command."""

import sys

from faceedit_app.cli import main

sys.exit(main())
