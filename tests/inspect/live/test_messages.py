"""What a page may say, what is kept of a burst of it, and what becomes of it with every machine."""

from __future__ import annotations

import asyncio
import itertools
import json
import math
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.formats.load import load
from chainbuild.inspect.live.answers import answered
from chainbuild.inspect.live.hub import Hub, Tab
from chainbuild.inspect.live.messages import parsed
from chainbuild.inspect.live.sections import section
from chainbuild.inspect.live.session import Session
from chainbuild.machines import shipped

MACHINE = "scara_kin36"
SAMPLE = ("scara_kin36", "c_face_kin14")  # quick ones

SAID = [
    ("axes", [1, 2.5, -3e5]),
    ("datum", {"key": "HD1", "value": 1}),
    ("reset", None),
    ("reset", "HD1"),
    ("convention", {"name": "c_sum", "choice": "x"}),
    ("moves", "HD1"),
    ("section", None),
    ("section", "rz"),
    ("restore", {"values": {"HD1": 1.5}, "choices": {"c_sum": "x"}, "axes": [0]}),
    ("model", None),
    ("presets", None),
    ("ask", {"id": 1, "fk": [0]}),
    ("ask", {"id": 1, "ik": [0], "start": [0]}),
    ("ask", {"id": 1, "ik_all": [0], "start": [0]}),
]


@pytest.mark.parametrize(("kind", "content"), SAID)
def test_messages_of_a_page(kind: str, content: Any) -> None:
    """Each kind is read as it is."""
    message = parsed(json.dumps({kind: content}))
    assert (message.kind, message.content) == (kind, content)


REFUSED = [
    *(
        "",
        " ",
        "null",
        "1",
        '""',
        "[]",
        "{}",
        "{",
        '{"x":1}',
        '{"\\ud800":1}',
        '\ufeff{"model":null}',
        '{"model":null} x',
    ),
    *('{"model":null,"presets":null}', '{"model":null,"model":null}', '{"axes":[0],"axes":[1]}', '{"model":{}}'),
    *('{"axes":[NaN]}', '{"axes":[Infinity]}', '{"axes":[-Infinity]}', '{"axes":[1e999]}', '{"axes":[-1e200]}'),
    *(
        '{"axes":[1' + 39 * "0" + "0]}",
        '{"axes":[' + 60_000 * "1" + "]}",
        '{"axes":' + 30_000 * "[" + "}",
        65_536 * "[",
    ),
    *('{"axes":null}', '{"axes":1}', '{"axes":[true]}', '{"axes":["0"]}', '{"axes":[null]}', '{"axes":[[0]]}'),
    *('{"datum":{}}', '{"datum":{"key":"x"}}', '{"datum":{"key":1,"value":1}}', '{"datum":{"key":"x","value":"1"}}'),
    *(
        '{"datum":{"key":"x","value":1,"more":1}}',
        '{"datum":{"key":"x","key":"y","value":1}}',
        '{"reset":1}',
        '{"moves":null}',
    ),
    *('{"section":1}', '{"convention":{"name":"x","choice":1}}', '{"restore":{"values":{},"choices":{}}}'),
    *('{"restore":{"values":{"x":"1"},"choices":{},"axes":[]}}', '{"restore":{"values":[],"choices":{},"axes":[]}}'),
    *(
        '{"ask":{"id":1}}',
        '{"ask":{"id":"1","fk":[0]}}',
        '{"ask":{"id":1,"ik":[0]}}',
        '{"ask":{"id":1,"fk":[0],"ik":[0]}}',
    ),
    *('{"ask":{"id":true,"fk":[0]}}', '{"ask":{"fk":[0]}}', '{"model":null}' + 65_536 * " "),
]


@pytest.mark.parametrize("text", [*REFUSED, b'{"model":null}'], ids=lambda text: str(text)[:24])
def test_what_is_no_message(text: str | bytes) -> None:
    """It is refused in words that show its beginning at most."""
    with pytest.raises(ChainbuildError) as refused:
        parsed(text)
    assert len(str(refused.value)) < 300


class Listener:
    """A connection to a tab that keeps what is sent; as long as it is not ready nothing is on its way."""

    def __init__(self) -> None:
        self.heard: list[dict[str, Any]] = []
        self.ready = asyncio.Event()
        self.ready.set()

    async def send(self, text: str) -> None:
        """Keep a text."""
        await self.ready.wait()
        self.heard.append(json.loads(text, parse_constant=pytest.fail))

    def last(self, kind: str) -> Any:
        """Return the content of the last message of a kind."""
        return [one[kind] for one in self.heard if kind in one][-1]


def _played(play: Callable[[Hub, list[Listener], list[Tab]], Awaitable[None]], machine: str = MACHINE) -> Session:
    """Run a play of a session and two tabs; return the session."""
    session = Session(load(machine))

    async def run() -> None:
        hub, listeners = Hub(session), [Listener(), Listener()]
        tabs = [hub.joined(one) for one in listeners]
        for one in tabs:
            await hub.greet(one)
        try:
            await play(hub, listeners, tabs)
        finally:
            await hub.close()

    asyncio.run(run())
    return session


async def _until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(10):
        while not condition():
            await asyncio.sleep(0.005)


def _say(kind: str, content: Any) -> str:
    return json.dumps({kind: content})


def test_last_value_wins() -> None:
    """Of a burst only the last of each kind is acted on, but nothing of another datum is lost."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        for n in range(50):
            await hub.told(tabs[0], _say("datum", {"key": "HD2", "value": 300.0 + n}))
            await hub.told(tabs[0], _say("datum", {"key": "HD1", "value": 400.0 + n}))
            await hub.told(tabs[0], _say("axes", [float(n), 0, 0, 0]))
        await _until(lambda: any("axes" in one and one["axes"]["axes"][0] == 49 for one in listeners[1].heard))
        assert listeners[1].last("model")["live"]["values"] == {"HD1": 449.0, "HD2": 349.0}
        assert listeners[0].last("model") == listeners[1].last("model")
        assert not any("axes" in one for one in listeners[0].heard)  # it has them

    session = _played(play)
    assert session.axes.tolist() == [49, 0, 0, 0]
    assert session.number < 10


def test_order_of_what_waits() -> None:
    """A change that takes the place of an earlier one comes after what was said in between."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        for kind, content in (("datum", {"key": "HD1", "value": 333.0}), ("reset", None), ("axes", [7, 0, 0, 0])):
            await hub.told(tabs[0], _say(kind, content))
            await hub.told(tabs[0], _say("datum", {"key": "HD1", "value": 444.0}))
        heard = listeners[1]
        await _until(lambda: any("axes" in one for one in heard.heard))
        await _until(lambda: heard.last("model")["live"]["values"] == {"HD1": 444.0})

    assert _played(play).values == {"HD1": 444.0}


def test_tabs_that_move_at_once_end_in_step() -> None:
    """What one was told may have crossed what it sent: at rest both are told the same."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        await hub.told(tabs[0], _say("axes", [1, 0, 0, 0]))
        await hub.told(tabs[1], _say("axes", [2, 0, 0, 0]))
        await _until(lambda: all(any(one.get("axes", {}).get("by") == 0 for one in who.heard) for who in listeners))
        assert [one.last("axes") for one in listeners] == 2 * [{"axes": [2, 0, 0, 0], "by": 0}]

    assert _played(play).axes.tolist() == [2, 0, 0, 0]


def test_slow_tab_is_told_the_newest_alone() -> None:
    """What it has not taken is not kept."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        await _until(lambda: bool(listeners[1].heard))
        listeners[1].ready.clear()
        for n in range(20):
            await hub.told(tabs[0], _say("axes", [float(n), 0, 0, 0]))
            await asyncio.sleep(0.005)
        await _until(lambda: len([one for one in listeners[0].heard if "contacts" in one]) > 5)
        listeners[1].ready.set()
        await _until(lambda: any(one.get("axes", {}).get("axes") == [19, 0, 0, 0] for one in listeners[1].heard))
        assert len([one for one in listeners[1].heard if "axes" in one]) <= 2

    _played(play)


def test_tab_that_leaves_has_said_what_it_has_said() -> None:
    """Its last change reaches the others, and it is told nothing more."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        await hub.told(tabs[0], _say("datum", {"key": "HD1", "value": 333.0}))
        await hub.told(tabs[0], _say("moves", "HD1"))
        await hub.told(tabs[0], _say("axes", [5, 0, 0, 0]))
        hub.left(tabs[0])
        heard = len(listeners[0].heard)
        await _until(lambda: any("axes" in one for one in listeners[1].heard))
        assert listeners[1].last("model")["live"]["values"] == {"HD1": 333.0}
        assert len(listeners[0].heard) == heard
        assert tabs[0].number not in hub._tabs

    _played(play)


def test_state_that_is_not_taken_back() -> None:
    """A page whose kept state does not fit any more is told what there is."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        before = hub.refused
        kept = {"values": {"gone": 1.0}, "choices": {}, "axes": [9, 0, 0, 0]}
        await hub.told(tabs[0], _say("restore", kept))
        await _until(lambda: any("refused" in one for one in listeners[0].heard))
        assert hub.refused == before + 1
        assert listeners[0].last("model")["live"]["values"] == {}
        assert listeners[0].last("axes")["axes"] != kept["axes"]
        assert not any("model" in one for one in listeners[1].heard)

    _played(play)


def test_many_questions_are_all_answered() -> None:
    """Other than values, none replaces another."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        for n in range(200):
            await hub.told(tabs[0], _say("ask", {"id": n, "fk": [n, 0, 0, 0]}))
        await _until(lambda: len([one for one in listeners[0].heard if "answer" in one]) == 200)
        assert [one["answer"]["id"] for one in listeners[0].heard if "answer" in one] == list(range(200))

    _played(play)


def test_unknown_names_are_refused() -> None:
    """Of data, conventions and sections: nothing is built for them."""

    async def play(hub: Hub, listeners: list[Listener], tabs: list[Tab]) -> None:
        texts = [
            *(_say("datum", {"key": "x", "value": 1}), _say("reset", "x"), _say("moves", "x"), _say("section", "x")),
            *(_say("convention", {"name": "x", "choice": "x"}), _say("datum", {"key": "HD1", "value": 1e99})),
        ]
        for count, text in enumerate(texts, start=1):
            await hub.told(tabs[0], text)
            await _until(lambda count=count: hub.refused == count)  # type: ignore[misc]
        assert not any("model" in one for one in listeners[0].heard)

    assert _played(play).number == 1


def test_answers_are_json() -> None:
    """Also where a number is missing; whatever pose and start are asked for."""
    session = Session(load("cardan_head_kin59"))
    count = len(session.axes)
    pose = session.robot.fk(session.axes).homogeneous.ravel().tolist()
    far = [*pose[:3], 50.0, *pose[4:]]
    for asked in (far, 16 * [0.0], [1.0], 16 * [1e99]):
        for kind in ("ik", "ik_all"):
            question = {"id": 1, kind: asked, "start": count * [1e9 - 1]}
            json.dumps(answered(session.robot, question), allow_nan=False)
    found = answered(session.robot, {"id": 1, "ik": pose, "start": session.axes.tolist()})["ik"]
    assert found["status"] == "ok"
    assert found["axes"] == pytest.approx(session.axes.tolist(), abs=1e-6)
    assert found["position_error"] < 1e-6


def test_section_that_nobody_waits_for() -> None:
    """It is given up."""
    robot = Session(load(MACHINE)).robot
    asked = itertools.count()
    assert section(robot, "rz", lambda: next(asked) < 1) is None
    assert next(asked) == 2


def _all_changed(machine: str) -> None:
    """Give every datum of a machine another value and every convention each of its choices, and take them back."""
    session = Session(load(machine))

    def shown() -> None:
        for found in (session.hello(), session.model(), session.contacts()):
            json.dumps(found, allow_nan=False)

    for key, datum in session._list.data.items():
        json.dumps(session.moves(key), allow_nan=False)
        others = [datum.value + 1.0] if datum.unit else [one for one in datum.others if one != datum.value]
        for value in others:
            try:
                session.change({key: value})
            except ChainbuildError:
                assert session.values == {}
                continue
            assert session.values == {key: value}
            shown()
            session.reset(key)
            assert session.values == {}
    for one in session.robot.chain.conventions:
        for choice in one.convention.choices:
            try:
                session.change({}, {one.convention.name: choice})
            except ChainbuildError:
                continue
            shown()
            session.reset()
    for value in (0.0, 90.0, 1e9 - 1):
        session.move([value] * len(session.axes))
        shown()
    session.reset()
    assert all(math.isfinite(value) for value in session.axes)


@pytest.mark.parametrize("machine", SAMPLE)
def test_every_change_of_a_machine(machine: str) -> None:
    """It is shown, or refused in words."""
    _all_changed(machine)


@pytest.mark.slow
@pytest.mark.parametrize("machine", sorted(set(shipped()) - set(SAMPLE)))
def test_every_change_of_every_machine(machine: str) -> None:
    """It is shown, or refused in words."""
    _all_changed(machine)
