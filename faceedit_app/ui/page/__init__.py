"""The page with an open take: its bars, and what lies over it."""
