"""The type of a place in one of Qt's models."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex

Index = QModelIndex | QPersistentModelIndex
"""What Qt gives to the methods of a model or a delegate."""
