"""From a list of edits to weights: what is asked for, the networks' answer, reach."""
