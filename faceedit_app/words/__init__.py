"""The words that were said: aligned to the sound of a take, read from files and written to them."""
