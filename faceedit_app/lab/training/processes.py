"""Several processes that share a training: `torchrun --nproc-per-node 3 -m faceedit_app train ...`.

Each network of each region is trained by one process, whole and in the same way as alone. So any
number of processes gives the same networks, to the bit; six of them leave nothing more to share.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import timedelta
from typing import TypeVar

import torch.distributed as dist

T = TypeVar("T")

# Until the slowest process is done; the library's own limit is half an hour.
_PATIENCE = timedelta(days=7)


@dataclass(frozen=True)
class Processes:
    """This process among those that share a training.

    Attributes:
        number: from 0; the first writes what belongs to all.
        count: how many there are.
    """

    number: int = 0
    count: int = 1

    def takes(self, job: int) -> bool:
        """Whether a job, by its number, is this process's."""
        return job % self.count == self.number

    def gather(self, mine: T) -> list[T]:
        """What all processes have, in order; waits for them. For all but the first, nothing."""
        if self.count == 1:
            return [mine]
        found: list[T | None] | None = [None] * self.count if self.number == 0 else None
        dist.gather_object(mine, found)
        return [each for each in found or () if each is not None]


@contextmanager
def processes() -> Iterator[Processes]:
    """The processes that `torchrun` started; without it, this one alone."""
    if not dist.is_torchelastic_launched() or int(os.environ["WORLD_SIZE"]) == 1:
        yield Processes()
        return
    dist.init_process_group("gloo", timeout=_PATIENCE)
    try:
        yield Processes(dist.get_rank(), dist.get_world_size())
    finally:
        dist.destroy_process_group()
