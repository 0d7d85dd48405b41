"""Project files, edits files, the journal, and fingerprints of takes."""

PROJECT_SUFFIX = ".faceedit"
