"""The kinds of networks that can be trained; each exports to a file that the application reads."""

from __future__ import annotations

from faceedit_app.lab.training.architectures.base import Architecture, Stacked
from faceedit_app.lab.training.architectures.holden import HoldenNetworks
from faceedit_app.lab.training.architectures.unet import UNets

__all__ = ["ARCHITECTURES", "Architecture", "Stacked"]

ARCHITECTURES: dict[str, type[Architecture]] = {kind.name: kind for kind in (UNets, HoldenNetworks)}
