"""The look of the window: Qt's Fusion style with our palette and one style sheet."""

from __future__ import annotations

from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication

from faceedit_app.ui.look.icons import icon_file
from faceedit_app.ui.look.palette import (
    ACCENT,
    ACCENT_DEEP,
    ACCENT_HOVER,
    BACKGROUND,
    BORDER,
    DISABLED,
    FAINT,
    HOVER,
    MUTED,
    ORANGE,
    PANEL,
    RAISED,
    TEXT,
)

GAP = 8  # pixels between groups of controls; half of it inside a group
MARGIN = 10  # pixels from a bar's edge to its content

_TICK = icon_file("tick").as_posix()  # black, on the accent
_MENU_TICK = icon_file("menu_tick").as_posix()  # Qt's own is ragged on fine screens
_DIM_TICK = icon_file("menu_tick_disabled").as_posix()
_ARROW = icon_file("list_arrow").as_posix()  # of lists that are not our own, as in file dialogs

_STYLE = f"""
QMainWindow, QDialog, QMessageBox {{ background: {BACKGROUND}; }}
QDialogButtonBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
QMessageBox QPushButton, QDialogButtonBox QPushButton {{ padding: 5px 16px; }}
QMenuBar {{ background: {BACKGROUND}; padding: 2px 4px; }}
QMenuBar::item {{ padding: 4px 9px; border-radius: 4px; background: transparent; }}
QMenuBar::item:selected {{ background: {RAISED}; }}
QMenu {{ background: {PANEL}; border: 1px solid {BORDER}; padding: 4px; }}
QMenu::item {{ padding: 4px 26px 4px 26px; border-radius: 3px; }}
QMenu::item:selected {{ background: {ACCENT_DEEP}; }}
QMenu::item:disabled {{ color: {DISABLED}; }}
QMenu::separator {{ height: 1px; background: {BORDER}; margin: 4px 6px; }}
QMenu::icon {{ padding-left: 6px; }}
QMenu::icon:checked {{
    background: {ACCENT_DEEP}; border: 1px solid {ACCENT}; border-radius: 4px; padding: 2px;
}}
QMenu::icon:checked:disabled {{ background: transparent; border-color: {FAINT}; }}
QMenu::indicator {{ width: 16px; height: 16px; padding-left: 4px; }}
QMenu::indicator:checked {{ image: url("{_MENU_TICK}"); }}
QMenu::indicator:checked:disabled {{ image: url("{_DIM_TICK}"); }}
QToolTip {{ background: {RAISED}; color: {TEXT}; border: 1px solid {BORDER}; padding: 4px 6px; }}

QWidget#bar {{ background: {PANEL}; }}
QWidget#tools {{ background: {PANEL}; border-top: 1px solid {BACKGROUND}; }}
QWidget#transport {{ background: {PANEL}; border-top: 1px solid {BACKGROUND}; }}
QStatusBar {{ background: {BACKGROUND}; color: {MUTED}; }}
QStatusBar::item {{ border: none; }}
QStatusBar QLabel {{ color: {MUTED}; padding: 0 2px; }}
QStatusBar QLabel[attention="true"] {{ color: {ORANGE}; }}
QLabel#caption {{ color: {MUTED}; }}
QLabel#clock {{ font-weight: 600; }}
QFrame#line {{ background: {BORDER}; border: none; }}

QToolButton, QPushButton {{
    background: {RAISED}; border: 1px solid transparent; border-radius: 5px; padding: 4px 10px;
}}
QToolButton:hover, QPushButton:hover {{ background: {HOVER}; }}
QToolButton:pressed, QPushButton:pressed {{ background: {BORDER}; }}
QToolButton:checked {{ background: {ACCENT_DEEP}; }}
QToolButton:disabled, QPushButton:disabled {{ color: {DISABLED}; background: {PANEL}; }}
QToolButton:focus, QPushButton:focus {{ border-color: {ACCENT}; }}
QToolButton#icon {{ background: transparent; padding: 5px; }}
QToolButton#icon:hover {{ background: {HOVER}; }}
QToolButton#icon:checked {{ background: {ACCENT_DEEP}; }}
QToolButton#tool {{ background: transparent; padding: 4px; }}
QToolButton#tool:hover {{ background: {HOVER}; }}
QToolButton#tool:checked {{ background: {ACCENT_DEEP}; }}
QToolButton#tool:disabled, QToolButton#small:disabled {{ background: transparent; }}
QToolButton#tool::menu-indicator {{ image: none; width: 0; }}
QToolButton#small {{ background: transparent; padding: 2px; }}
QToolButton#small:hover {{ background: {HOVER}; }}
QToolButton#accept {{ background: {ACCENT_DEEP}; padding: 2px 10px; }}
QToolButton#small_button {{ padding: 2px 10px; }}
QToolButton#proposal_button {{ background: transparent; padding: 2px 7px; }}
QToolButton#proposal_button:hover {{ background: {HOVER}; }}
QToolButton#accept:hover {{ background: {ACCENT_HOVER}; }}
QToolButton#play {{ padding: 5px 12px; }}
QPushButton#primary {{ background: {ACCENT_DEEP}; padding: 8px 18px; }}
QPushButton#primary:hover {{ background: {ACCENT_HOVER}; }}
QPushButton#secondary {{ padding: 8px 18px; }}
QPushButton#link {{
    background: transparent; color: {ACCENT}; padding: 3px 0; text-align: left;
}}
QPushButton#count {{ background: transparent; padding: 2px 0 2px 10px; text-align: left; }}
QPushButton#count:hover {{ background: {HOVER}; }}
QPushButton#link:hover {{ background: {PANEL}; }}
QPushButton#primary:focus, QPushButton#secondary:focus, QPushButton#link:focus {{
    border-color: {ACCENT};
}}

QFileDialog QToolButton {{ padding: 3px; }}

QToolButton#segment_left {{ border-top-right-radius: 0; border-bottom-right-radius: 0; }}
QToolButton#segment_middle {{ border-radius: 0; }}
QToolButton#segment_right {{ border-top-left-radius: 0; border-bottom-left-radius: 0; }}

QAbstractSpinBox, QComboBox, QPlainTextEdit {{
    background: {BACKGROUND}; border: 1px solid {BORDER}; border-radius: 4px;
    padding: 2px 6px; min-height: 20px; selection-background-color: {ACCENT_DEEP};
}}
QAbstractSpinBox#small {{ padding: 0 2px; min-height: 19px; }}
QAbstractSpinBox:focus, QComboBox:focus, QPlainTextEdit:focus {{ border-color: {ACCENT}; }}
QAbstractSpinBox::up-button, QAbstractSpinBox::down-button {{ width: 0; border: none; }}
QTableView QComboBox {{ combobox-popup: 0; }}  /* scrolls: a head may have hundreds of shapes */
QComboBox::drop-down {{ border: none; width: 16px; }}
QFileDialog QComboBox::down-arrow {{ image: url("{_ARROW}"); width: 12px; height: 12px; }}
QComboBox QAbstractItemView {{
    background: {PANEL}; border: 1px solid {BORDER}; selection-background-color: {ACCENT_DEEP};
}}

QCheckBox {{ border: 1px solid transparent; border-radius: 3px; padding: 1px; }}
QCheckBox:focus {{ border-color: {ACCENT}; }}
QCheckBox::indicator, QTreeView::indicator {{
    width: 14px; height: 14px; border: 1px solid {FAINT}; border-radius: 3px;
}}
QCheckBox::indicator:checked, QTreeView::indicator:checked {{
    background: {ACCENT}; border-color: {ACCENT}; image: url("{_TICK}");
}}
QCheckBox::indicator:disabled {{ border-color: {BORDER}; background: transparent; }}
QCheckBox::indicator:checked:disabled {{ background: {BORDER}; }}
QCheckBox:disabled {{ color: {DISABLED}; }}

QSlider {{ border: 1px solid transparent; border-radius: 4px; }}
QSlider:focus {{ border-color: {ACCENT}; }}
QSlider::groove:horizontal {{ height: 4px; background: {BORDER}; border-radius: 2px; }}
QSlider::sub-page:horizontal {{ background: {ACCENT}; border-radius: 2px; }}
QSlider::sub-page:horizontal:disabled {{ background: {FAINT}; }}
QSlider::handle:horizontal {{
    width: 12px; height: 12px; margin: -5px 0; border-radius: 6px; background: {TEXT};
}}
QSlider::handle:horizontal:disabled {{ background: {FAINT}; }}

QWidget#edits {{ background: {PANEL}; }}
QLabel#heading {{ font-weight: 600; }}
QListView {{ background: {BACKGROUND}; border: 1px solid transparent; outline: none; }}
QListView:focus {{ border-color: {ACCENT}; }}
QLineEdit {{
    background: {BACKGROUND}; border: 1px solid {BORDER}; border-radius: 3px; padding: 0 4px;
    selection-background-color: {ACCENT_DEEP};
}}
QAbstractSpinBox#small QLineEdit {{ padding: 0 2px; }}
QLineEdit:focus {{ border-color: {ACCENT}; }}
QDialog QLineEdit, QLineEdit#find_word, QLineEdit#search {{ min-height: 20px; }}
QLineEdit[refused="true"], QAbstractSpinBox[refused="true"] {{
    border-color: {ORANGE}; color: {ORANGE};
}}
QLabel#reason {{
    background: {PANEL}; color: {ORANGE}; border: 1px solid {ORANGE}; border-radius: 3px;
    padding: 2px 6px;
}}

QTabWidget::pane {{ border: none; }}
QTabBar {{ background: {BACKGROUND}; }}
QTabBar::tab {{
    background: {BACKGROUND}; color: {MUTED}; padding: 4px 12px; border: 1px solid transparent;
}}
QTabBar::tab:selected {{ background: {PANEL}; color: {TEXT}; border-top: 2px solid {ACCENT}; }}
QTabBar::tab:hover {{ color: {TEXT}; }}
QTabBar::tab:selected:focus {{ border: 1px solid {ACCENT}; border-top-width: 2px; }}
QDialog QScrollArea {{ border: 1px solid transparent; }}
QDialog QScrollArea:focus, QTableView:focus {{ border: 1px solid {ACCENT}; }}
QTreeView {{ background: {BACKGROUND}; border: 1px solid transparent; outline: none; }}
QTreeView:focus {{ border-color: {ACCENT}; }}
QTreeView::item {{ padding: 3px 15px 3px 5px; }}  /* under their titles, which have arrows */
QTreeView::item:selected {{ background: {ACCENT_DEEP}; color: {TEXT}; }}
QHeaderView::section {{
    background: {PANEL}; color: {MUTED}; border: none; padding: 3px 8px;
}}
QTreeView QHeaderView::section {{ padding-right: 18px; }}

QSplitter::handle {{ background: {BACKGROUND}; }}
QSplitter::handle:hover {{ background: {ACCENT_DEEP}; }}
QScrollBar:vertical {{ width: 10px; background: transparent; }}
QScrollBar::handle:vertical {{ background: {BORDER}; border-radius: 4px; min-height: 30px; }}
QScrollBar::add-line, QScrollBar::sub-line {{ height: 0; width: 0; }}

QFrame#banner {{ background: #22384a; border-bottom: 1px solid {ACCENT_DEEP}; }}
QFrame#banner[warns="true"] {{ background: #3a3323; border-bottom: 1px solid #5a4a22; }}
QFrame#banner QLabel {{ color: {TEXT}; }}
QFrame#proposal {{ background: #22384a; border-bottom: 1px solid {ACCENT_DEEP}; }}
QFrame#hint {{ background: {PANEL}; border: 1px solid {ACCENT_DEEP}; border-radius: 10px; }}
QLabel#hint_title {{ font-size: 13pt; font-weight: 600; }}
QFrame#drop {{ border: 2px dashed {BORDER}; border-radius: 14px; background: transparent; }}
QFrame#drop[active="true"] {{ border-color: {ACCENT}; background: {PANEL}; }}
QLabel#title {{ font-size: 20pt; font-weight: 600; }}
QLabel#lead {{ color: {MUTED}; font-size: 11pt; }}
"""


def apply_theme(app: QApplication) -> None:
    """Apply style, palette and style sheet to the application."""
    app.setStyle("fusion")
    app.setPalette(window_palette())
    font = QFont(app.font())
    font.setPointSizeF(max(font.pointSizeF(), 9.5) if font.pointSizeF() < 12 else 10.0)
    app.setFont(font)
    app.setStyleSheet(_STYLE)


def window_palette() -> QPalette:
    """The colours of widgets that the style sheet does not name."""
    role = QPalette.ColorRole
    colors = {
        role.Window: BACKGROUND,
        role.WindowText: TEXT,
        role.Base: BACKGROUND,
        role.AlternateBase: PANEL,
        role.Text: TEXT,
        role.Button: RAISED,
        role.ButtonText: TEXT,
        role.BrightText: ORANGE,
        role.ToolTipBase: RAISED,
        role.ToolTipText: TEXT,
        role.PlaceholderText: MUTED,
        role.Highlight: ACCENT_DEEP,
        role.HighlightedText: TEXT,
        role.Link: ACCENT,
        role.Light: HOVER,
        role.Midlight: BORDER,
        role.Mid: BORDER,
        role.Dark: BACKGROUND,
        role.Shadow: "#101215",
    }
    palette = QPalette()
    for key, value in colors.items():
        palette.setColor(key, QColor(value))
    for key in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, key, QColor(DISABLED))
    return palette
