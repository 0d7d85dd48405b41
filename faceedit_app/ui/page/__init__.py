"""The page with an open take, its bars and its overlays."""
