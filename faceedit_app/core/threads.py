"""Run matrix products on one thread, so that results do not depend on the number of threads.

The last bits of a product depend on how BLAS divides it among threads. For matrices this small a
second thread gains nothing, and on a busy machine the two wait for each other.
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
    """Make every BLAS of this process, loaded now or later, use one thread.

    Called when the package is imported, before anything is computed.
    """
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    if "numpy" in sys.modules:  # it has already read the variables
        from threadpoolctl import threadpool_limits  # 10 ms, not needed when FaceEdit starts

        threadpool_limits(1, user_api="blas")
