"""The packings of a recording as a sequence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ._grainlab import Packing, Recording


class Packings(Sequence[Packing]):
    """The packings of a recording, in SI units: a sequence, of which each is read as it is asked for.

    Going through it reads once; an index reads what is before it. Raises IndexError, and FileError for damage: after the packings that can
    be read if you go through them, and at once for an index behind the damage.

    >>> recording.packings()[-1], len(recording.packings())
    """

    def __init__(self, recording: Recording, topic: str) -> None:
        self._recording, self._topic = recording, topic
        # A topic that is not there is an error here.
        recording._packings(topic)

    def __len__(self) -> int:
        topics = self._recording.topics
        return next(topics[name]["messages"] for name in (self._topic, "/" + self._topic) if name in topics)

    def __iter__(self) -> Iterator[Packing]:
        return self._recording._packings(self._topic)

    def __getitem__(self, at: Any) -> Any:
        size = len(self)
        places = list(range(size)[at]) if isinstance(at, slice) else [range(size)[at]]
        reader, passed, found = self._recording._packings(self._topic), 0, {}
        for place in sorted(places):
            found[place], passed = reader.after(place - passed), place + 1
        return [found[place] for place in places] if isinstance(at, slice) else found[places[0]]
