"""Networks in torch that were never trained."""

from __future__ import annotations

import torch

from faceedit_app.core.regions import Region
from faceedit_app.lab.training.architectures.unet import UNets
from faceedit_app.lab.training.model_files import TrainedRegion
from support.faces import shipped_rig
from support.networks import random_description

# Networks this small gain nothing from threads, and lose much where others use the machine.
torch.set_num_threads(1)


def random_networks(
    controls: int, channels: int, widths: tuple[int, ...] = (4, 6), seed: int = 0
) -> UNets:
    """Untrained U-Nets in which the autoencoder answers as well."""
    torch.manual_seed(seed)
    networks = UNets(controls, channels, widths, activation="silu")
    torch.nn.init.normal_(networks.autoencoder.out.weight, std=0.2)
    for module in networks.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            assert module.running_mean is not None
            assert module.running_var is not None
            module.running_mean.uniform_(-0.1, 0.1)
            module.running_var.uniform_(0.5, 1.5)
    return networks.eval()


def random_trained(region: Region, seed: int = 0) -> TrainedRegion:
    """A region's networks with a description that fits."""
    networks = random_networks(len(region.controls), len(region.channels), seed=seed)
    description = random_description(
        region,
        shipped_rig(),
        seed,
        architecture={"name": networks.name, **networks.settings},
        scale=networks.scale,
        context=networks.radius,
    )
    return TrainedRegion(description, networks)
