"""A unit that a channel's numbers can hardly be in."""

from __future__ import annotations

from pdoik.errors import LoadError


class SuspectedUnitError(LoadError):
    """A channel whose numbers look like another unit's: it is asked about, not guessed."""

    def __init__(self, message: str, channel: str, suspected: str, why: str) -> None:
        """Made with the channel as `units:` names it, the unit it looks like, and why."""
        super().__init__(message)
        self.channel, self.suspected, self.why = channel, suspected, why
