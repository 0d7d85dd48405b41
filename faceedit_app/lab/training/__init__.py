"""Making the networks: data, synthesis, fitting."""
