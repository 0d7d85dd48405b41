"""What all other rooms build on: clips, rigs, controls, regions and errors."""
