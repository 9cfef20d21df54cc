"""The layout of a narrow window: the picture is above and the panel below, each half of it."""

from __future__ import annotations

import viser

NARROW = 800  # widest such window [px]

_MARK = "pdoik-panel"
_PANEL = f".mantine-Paper-root:has(.{_MARK})"  # floating, or viser's own below 576 px
_OPEN = f'body:has(.{_MARK}):not(:has([aria-hidden="true"] .{_MARK}))'
_HEADER = "2.75em"  # of a floating panel
# dvh: what a telephone's browser leaves below its own bars; vh: where it knows no dvh.
_STYLE = f"""
@media (max-width: {NARROW}px) {{
  {_OPEN} [data-dock-root] > div:has(canvas) {{ inset: 0 0 50% 0 !important; }}
  {_PANEL} {{
    left: 0 !important; right: 0 !important; top: auto !important; bottom: 0 !important;
    width: 100% !important; max-width: none !important; max-height: 50% !important;
  }}
  {_PANEL} div[style*="max-height"] {{
    max-height: calc(50vh - {_HEADER}) !important;
    max-height: calc(50dvh - {_HEADER}) !important;
  }}
  {_PANEL} .mantine-ScrollArea-content > div {{ width: 100% !important; }}
}}"""


def stack_when_narrow(gui: viser.GuiApi) -> None:
    """Style the page so; what is folded away leaves the whole window to the picture.

    The style is in the panel, and goes with its contents when these are folded away.
    """
    gui.add_html(f'<div class="{_MARK}"><style>{_STYLE}</style></div>')
