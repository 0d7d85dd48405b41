"""From edits to weights: what is asked for, the networks' answer, and reach."""
