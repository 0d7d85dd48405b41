"""The laboratory: training, evaluation, bench. The application never imports it."""
