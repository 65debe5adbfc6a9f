"""Keeps the tabs of a live page in step with the session: the last value wins, and nothing piles up."""

from __future__ import annotations

import asyncio
import itertools
import json
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Protocol, TypeVar

from chainbuild.errors import ChainbuildError
from chainbuild.files import printable
from chainbuild.formats.load import load
from chainbuild.inspect.live.answers import answered
from chainbuild.inspect.live.messages import Message, parsed
from chainbuild.inspect.live.sections import section
from chainbuild.inspect.live.session import Session

Found = TypeVar("Found")


class Sender(Protocol):
    """The connection to a tab."""

    async def send(self, text: str) -> None:
        """Send a text; returns when it is on its way, whether or not the tab is still there."""


class Tab:
    """A tab that is connected: of each kind of message only the last waits to be sent.

    Args:
        sender: The connection.
        number: Of the tab.
    """

    def __init__(self, sender: Sender, number: int) -> None:
        self.number = number
        self._sender = sender
        self._waiting: dict[str, Any] = {}
        self._sending: asyncio.Task[None] | None = None

    def post(self, kind: str, content: Any) -> None:
        """Send a message as soon as the tab has taken what was sent before."""
        self._waiting.pop(kind, None)  # a newer one keeps to the order of the new ones
        self._waiting[kind] = content
        if self._sending is None or self._sending.done():
            self._sending = asyncio.get_running_loop().create_task(self._send())

    async def _send(self) -> None:
        while self._waiting:
            kind = next(iter(self._waiting))
            await self.say(kind, self._waiting.pop(kind))

    async def say(self, kind: str, content: Any) -> None:
        """Send a message at once."""
        await self._sender.send(json.dumps({kind: content}, separators=(",", ":")))

    def close(self) -> None:
        """Send nothing more."""
        self._waiting.clear()


class Hub:
    """The session, its tabs, and the one thread in which the session computes.

    Args:
        session: The session.

    Attributes:
        refused: How many messages were refused so far.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._tabs: dict[int, Tab] = {}
        self._numbers = itertools.count(1)
        self._worker = ThreadPoolExecutor(1, "session")
        self._sections = ThreadPoolExecutor(1, "section")  # takes seconds, in which the machine is moved on
        self._asked: tuple[list[float], int] | None = None  # axis values not taken yet, and of which tab
        self._moving: asyncio.Task[None] | None = None
        self.refused = 0

    async def _computed(self, act: Callable[[], Found]) -> Found:
        return await asyncio.get_running_loop().run_in_executor(self._worker, act)

    def close(self) -> None:
        """Compute nothing more."""
        self._worker.shutdown(wait=False, cancel_futures=True)
        self._sections.shutdown(wait=False, cancel_futures=True)

    async def page(self, connects: str) -> str:
        """Return the page."""
        return await self._computed(lambda: self._session.page(connects))

    async def joined(self, sender: Sender) -> Tab:
        """Take up a tab and tell it where the session is."""
        tab = Tab(sender, next(self._numbers))
        self._tabs[tab.number] = tab
        hello, contacts = await self._computed(lambda: (self._session.hello(), self._session.contacts()))
        tab.post("hello", hello)
        tab.post("contacts", contacts)
        return tab

    def left(self, tab: Tab) -> None:
        """Forget a tab."""
        tab.close()
        self._tabs.pop(tab.number, None)

    async def told(self, tab: Tab, text: str | bytes) -> None:
        """Take a message of a tab; what is refused is told to it, and counted."""
        key = None
        try:
            message = parsed(text)
            if message.kind == "datum":
                key = message.content["key"]
            await self._act(tab, message)
        except ChainbuildError as error:
            self.refused += 1
            tab.post("refused", {"text": printable(str(error)), "key": key, "count": self.refused})

    async def _act(self, tab: Tab, message: Message) -> None:
        kind, content, session = message.kind, message.content, self._session
        if kind == "axes":
            # Many a second may come: those that nobody has looked at are passed over.
            self._asked = content, tab.number
            if self._moving is None or self._moving.done():
                self._moving = asyncio.get_running_loop().create_task(self._move())
        elif kind == "datum":
            await self._change(lambda: session.change({content["key"]: content["value"]}))
        elif kind == "convention":
            await self._change(lambda: session.change({}, {content["name"]: content["choice"]}))
        elif kind == "reset":
            await self._change(lambda: session.reset(content))
        elif kind == "restore":
            await self._change(lambda: session.restore(content["values"], content["choices"], content["axes"]))
            self._post("axes", {"axes": session.axes.tolist(), "by": 0})
        elif kind == "moves":
            tab.post("moves", await self._computed(lambda: session.moves(content)))
        elif kind == "kinematic":

            def chosen() -> dict[str, Any]:
                session.choose_kinematic(content)
                return session.hello()

            self._post("hello", await self._computed(chosen))
        elif kind == "model":
            tab.post("model", await self._computed(session.model))
        elif kind == "presets":
            tab.post("presets", await self._computed(session.presets))
        elif kind == "section":
            await self._section(tab, content)
        else:
            await tab.say("answer", await self._computed(lambda: answered(session.robot, content)))

    async def _move(self) -> None:
        while self._asked is not None:
            (axes, number), self._asked = self._asked, None
            try:
                contacts = await self._computed(lambda axes=axes: self._moved(axes))  # type: ignore[misc]
            except ChainbuildError as error:
                self.refused += 1
                self._post("refused", {"text": printable(str(error)), "key": None, "count": self.refused}, only=number)
                continue
            self._post("axes", {"axes": axes, "by": number}, but=number)
            self._post("contacts", contacts)

    def _moved(self, axes: list[float]) -> dict[str, Any]:
        self._session.move(axes)
        return self._session.contacts()

    async def _change(self, act: Callable[[], None]) -> None:
        def changed() -> tuple[dict[str, Any], dict[str, Any]]:
            act()
            return self._session.model(), self._session.contacts()

        model, contacts = await self._computed(changed)
        self._post("model", model)
        self._post("contacts", contacts)

    async def _section(self, tab: Tab, kind: str | None) -> None:
        if kind is None:
            return
        robot, number = self._session.robot, self._session.number
        found = await asyncio.get_running_loop().run_in_executor(self._sections, lambda: section(robot, kind))
        tab.post("section", {**found, "number": number})

    async def opened(self, name: str, content: bytes) -> None:
        """Show a machine file that was dropped on the page, in every tab.

        Raises:
            ChainbuildError: it is no machine file, or holds no kinematic that can be shown.
        """

        def opening() -> dict[str, Any]:
            with tempfile.TemporaryDirectory(prefix="chainbuild-") as folder:
                # Of the name only the last part, and of that no more than shows what it is.
                path = Path(folder) / (Path(printable(name).replace("\\", "/")).name[-100:] or "machine")
                path.write_bytes(content)
                self._session.open_file(load(path))
            return self._session.hello()

        self._post("hello", await self._computed(opening))

    def _post(self, kind: str, content: Any, *, but: int = 0, only: int = 0) -> None:
        for tab in self._tabs.values():
            if tab.number != but and only in (0, tab.number):
                tab.post(kind, content)
