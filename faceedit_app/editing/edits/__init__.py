"""What an edit is, how edits are answered, and the sound and film beside a take."""
