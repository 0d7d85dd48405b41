"""Faces over the network, as they happen: packets of Live Link Face, VMC and iFacialMocap (UDP)."""
