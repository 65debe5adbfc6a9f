"""Keeps the tabs of a live page in step with the session: the last value wins, and nothing piles up."""

from __future__ import annotations

import asyncio
import itertools
import json
import tempfile
from collections.abc import Awaitable, Callable, Hashable
from pathlib import Path, PurePath
from typing import Any, Final, Protocol

from chainbuild.chain.elements import Chain
from chainbuild.errors import ChainbuildError
from chainbuild.files import printable
from chainbuild.formats.load import load
from chainbuild.formats.machine import Machine
from chainbuild.inspect.live.answers import answered
from chainbuild.inspect.live.messages import Message, parsed
from chainbuild.inspect.live.sections import section
from chainbuild.inspect.live.session import Session
from chainbuild.inspect.live.worker import Worker
from chainbuild.robot import Robot

_HELD: Final = 64  # messages of a tab that wait; before more are read, these are done
_REST_S: Final = 0.2  # seconds without a motion: what tabs have sent until then has long arrived
_NAME: Final = 60  # characters of a dropped file's name, at most 240 bytes: file systems take 255
_PLAIN: Final = frozenset(" ._-+()[]")  # beside letters and digits, of a file's name


class Sender(Protocol):
    """The connection to a tab."""

    async def send(self, text: str) -> None:
        """Send a text; returns when it is on its way, whether or not the tab is still there."""


class _Lane:
    """What is done one after another; of things about the same that wait, only the last.

    Args:
        act: What is done: called with what a thing is about, and the thing.
    """

    def __init__(self, act: Callable[[Any, Any], Awaitable[None]]) -> None:
        self._act = act
        self._waiting: dict[Hashable, Any] = {}
        self._task: asyncio.Task[None] | None = None

    def put(self, about: Hashable, thing: Any) -> None:
        """Have a thing done when those before it are."""
        self._waiting.pop(about, None)  # a newer one keeps to the order of the new ones
        self._waiting[about] = thing
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._run())

    async def room(self) -> None:
        """Return when not too many wait."""
        if len(self._waiting) >= _HELD and self._task is not None:
            await asyncio.wait([self._task])

    async def _run(self) -> None:
        while self._waiting:
            about = next(iter(self._waiting))
            await self._act(about, self._waiting.pop(about))

    def clear(self) -> None:
        """Do nothing of what waits."""
        self._waiting.clear()

    @property
    def idle(self) -> bool:
        """Whether nothing waits."""
        return not self._waiting


class Tab:
    """A tab that is connected.

    Args:
        sender: The connection.
        number: Of the tab.
        obey: Acts on a message of the tab.
    """

    def __init__(self, sender: Sender, number: int, obey: Callable[[Tab, Message], Awaitable[None]]) -> None:
        async def act(_about: Hashable, message: Message) -> None:
            await obey(self, message)

        self.number = number
        self.closed = False
        self._sender = sender
        self._out = _Lane(self.say)
        # A section takes seconds, a question may, too: the machine is moved on meanwhile.
        self._lanes = {"section": _Lane(act), "ask": _Lane(act)}
        self._changes = _Lane(act)

    async def hear(self, message: Message) -> None:
        """Have a message acted on; returns when the next may be read."""
        lane = self._lanes.get(message.kind, self._changes)
        lane.put(message.about, message)
        await lane.room()

    def waits_for_section(self) -> bool:
        """Return whether the tab is still there, and has asked for no other section since."""
        return not self.closed and self._lanes["section"].idle

    def post(self, kind: str, content: Any) -> None:
        """Send a message as soon as the tab has taken what was sent before; only the last of a kind."""
        if not self.closed:
            self._out.put(kind, content)

    async def say(self, kind: str, content: Any) -> None:
        """Send a message at once."""
        await self._sender.send(json.dumps({kind: content}, separators=(",", ":")))

    def close(self) -> None:
        """Send nothing more; what the tab has changed stays changed."""
        self.closed = True
        for lane in (self._out, *self._lanes.values()):
            lane.clear()


class Hub:
    """The session, its tabs, and the threads that compute.

    Args:
        session: The session.

    Attributes:
        refused: How many messages were refused so far.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._tabs: dict[int, Tab] = {}
        self._numbers = itertools.count(1)
        self._computed = Worker("session")
        self._found = Worker("section")
        self._answered = Worker("questions")
        self._read = Worker("file")
        self._asked: tuple[Chain, Robot] | None = None  # the robot of the questions: one thread may use it
        self._mover = 0  # number of the tab that has moved the machine last; 0: none
        self._contested = False  # whether tabs have moved it at the same time, perhaps
        self._rest: asyncio.TimerHandle | None = None
        self.refused = 0

    async def close(self) -> None:
        """Compute nothing more."""
        for tab in self._tabs.values():
            tab.close()
        if self._rest is not None:
            self._rest.cancel()
        await asyncio.gather(*(one.end() for one in (self._computed, self._found, self._answered, self._read)))

    async def page(self, connects: str) -> str:
        """Return the page."""
        return await self._computed(lambda: self._session.page(connects))

    def joined(self, sender: Sender) -> Tab:
        """Take up a tab."""
        tab = Tab(sender, next(self._numbers), self._obey)
        self._tabs[tab.number] = tab
        return tab

    async def greet(self, tab: Tab) -> None:
        """Tell a tab where the session is."""
        hello, contacts = await self._computed(lambda: (self._session.hello(), self._session.contacts()))
        tab.post("hello", hello)
        tab.post("contacts", contacts)

    def left(self, tab: Tab) -> None:
        """Forget a tab."""
        tab.close()
        self._tabs.pop(tab.number, None)

    async def told(self, tab: Tab, text: str | bytes) -> None:
        """Take a message of a tab; what is refused is told to it, and counted."""
        try:
            message = parsed(text)
        except ChainbuildError as error:
            self._refuse(tab, error)
            return
        await tab.hear(message)

    def _refuse(self, tab: Tab, error: ChainbuildError, key: str | None = None) -> None:
        self.refused += 1
        tab.post("refused", {"text": in_words(error), "key": key, "count": self.refused})

    async def _obey(self, tab: Tab, message: Message) -> None:
        try:
            await self._act(tab, message)
        except ChainbuildError as error:
            if message.kind == "restore":  # the page shows what it has kept: it is told what there is
                tab.post("model", await self._computed(self._session.model))
                tab.post("axes", {"axes": self._session.axes.tolist(), "by": 0})
            self._refuse(tab, error, message.content["key"] if message.kind == "datum" else None)

    async def _act(self, tab: Tab, message: Message) -> None:
        kind, content, session = message.kind, message.content, self._session
        if kind == "axes":
            await self._move(tab, content)
        elif kind == "datum":
            await self._change(lambda: session.change({content["key"]: content["value"]}))
        elif kind == "convention":
            await self._change(lambda: session.change({}, {content["name"]: content["choice"]}))
        elif kind == "reset":
            await self._change(lambda: session.reset(content))
        elif kind == "restore":
            await self._change(lambda: session.restore(content["values"], content["choices"], content["axes"]))
            self._tell_axes()
        elif kind == "moves":
            tab.post("moves", await self._computed(lambda: session.moves(content)))
        elif kind == "kinematic":
            await self._choose(content)
        elif kind == "model":
            tab.post("model", await self._computed(session.model))
        elif kind == "presets":
            tab.post("presets", await self._computed(session.presets))
        elif kind == "section":
            await self._section(tab, content)
        else:
            await tab.say("answer", await self._answered(lambda: self._answer(content)))

    async def _move(self, tab: Tab, axes: list[float]) -> None:
        def moved() -> dict[str, Any]:
            self._session.move(axes)
            return self._session.contacts()

        contacts = await self._computed(moved)
        self._post("axes", {"axes": axes, "by": tab.number}, but=tab.number)
        self._post("contacts", contacts)
        # What another tab was told may have crossed what it sent: at rest all are told the same.
        self._contested = len(self._tabs) > 1 and (self._contested or self._mover not in (0, tab.number))
        self._mover = tab.number
        if self._rest is not None:
            self._rest.cancel()
        if self._contested:
            self._rest = asyncio.get_running_loop().call_later(_REST_S, self._tell_axes)

    def _tell_axes(self) -> None:
        """Tell every tab where the axes stand."""
        self._post("axes", {"axes": self._session.axes.tolist(), "by": 0})
        self._contested, self._mover = False, -1  # nobody: the next to move may not have seen it

    def _answer(self, question: dict[str, Any]) -> dict[str, Any]:
        chain = self._session.robot.chain
        if self._asked is None or self._asked[0] is not chain:
            self._asked = chain, Robot(chain)
        return answered(self._asked[1], question)

    async def _change(self, act: Callable[[], None]) -> None:
        def changed() -> tuple[dict[str, Any], dict[str, Any]]:
            act()
            return self._session.model(), self._session.contacts()

        model, contacts = await self._computed(changed)
        self._post("model", model)
        self._post("contacts", contacts)

    async def _choose(self, n: int) -> None:
        def chosen() -> dict[str, Any]:
            self._session.choose_kinematic(n)
            return self._session.hello()

        self._post("hello", await self._computed(chosen))

    async def _section(self, tab: Tab, kind: str | None) -> None:
        if kind is None:
            return
        chain, number = self._session.robot.chain, self._session.number
        try:
            found = await self._found(lambda: section(Robot(chain), kind, tab.waits_for_section))
        except ChainbuildError as error:  # said where the section would be
            found = {"kind": kind, "refused": in_words(error)}
        if found is not None:
            tab.post("section", {**found, "number": number})

    async def opened(self, name: str, content: bytes) -> None:
        """Show a machine file that was dropped on the page, in every tab.

        Raises:
            ChainbuildError: it is no machine file, or holds no kinematic that can be shown.
        """

        def shown(machine: Machine) -> dict[str, Any]:
            self._session.open_file(machine)
            return self._session.hello()

        machine = await self._read(lambda: _machine_of(name, content))
        self._post("hello", await self._computed(lambda: shown(machine)))

    def _post(self, kind: str, content: Any, *, but: int = 0) -> None:
        for tab in self._tabs.values():
            if tab.number != but:
                tab.post(kind, content)


def _machine_of(name: str, content: bytes) -> Machine:
    """Return the machine of a file's content."""
    # Of the name only the last part, and of that no more than shows what it is.
    last = "".join(one if one.isalnum() or one in _PLAIN else "_" for one in PurePath(name.replace("\\", "/")).name)
    with tempfile.TemporaryDirectory(prefix="chainbuild-") as folder:
        path = Path(folder) / (last[-_NAME:].strip(". ") or "machine")
        try:
            path.write_bytes(content)
        except OSError as error:
            raise ChainbuildError(f"the file cannot be taken: {error.strerror or error}") from None
        return load(path)


def in_words(error: ChainbuildError) -> str:
    """Return what is wrong, as a page shows it: pages are passed on, so a file is named without its folder."""
    text = str(error)
    if error.span is not None:
        text = text.replace(error.span.file, PurePath(error.span.file).name)
    return printable(text)
