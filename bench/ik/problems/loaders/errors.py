"""What a loader says when it refuses: the file, the entry, and what is wrong with it."""

from pdoik.scenes.values import EntryError as LoaderError

__all__ = ["LoaderError"]
