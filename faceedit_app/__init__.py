"""FaceEdit: edit tracked facial animation by dragging eight plain curves."""

from faceedit_app.core.threads import use_one_thread

__version__ = "0.1.0"

use_one_thread()
