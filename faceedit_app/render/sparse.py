"""scipy's sparse matrices.

scipy asks numpy for all that it has, which also imports its Fortran compiler, its tests, and other
parts that nobody uses here: most of the time that it takes.
"""

from faceedit_app.render.lazy import lazily

with lazily("numpy.f2py", "numpy.testing", "numpy.ma", "numpy.polynomial"):
    from scipy.sparse import csr_matrix, diags_array, identity

__all__ = ["csr_matrix", "diags_array", "identity"]
