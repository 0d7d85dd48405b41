"""Matrix products on one thread, so that results do not depend on how many there are.

The last bits of a product depend on how BLAS shares it among threads. On matrices as small as ours
a second thread gains nothing, and on a busy machine the two wait for each other.
"""

from __future__ import annotations

import os
import sys

_VARIABLES = (
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


def use_one_thread() -> None:
    """Have each BLAS of this process, loaded already or later, compute on one thread.

    Called when the package is imported, which is before anything of it can compute.
    """
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    if "numpy" in sys.modules:  # which has read its variable
        from threadpoolctl import threadpool_limits  # 10 ms, not needed where FaceEdit starts

        threadpool_limits(1, user_api="blas")
