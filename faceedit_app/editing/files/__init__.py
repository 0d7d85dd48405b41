"""Projects, the journal, and how a take's file is recognised."""

PROJECT_SUFFIX = ".faceedit"
