"""The menus' commands, one module per menu."""
