"""What the menus do, one file a menu."""
