"""What the tests of the batch share."""

from __future__ import annotations

from support.faces import models

__all__ = ["models"]
