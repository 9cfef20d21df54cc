"""Tabs, panels and menus of the page: each gets a `Page` or what it shows; `Viewer` makes them."""
