"""The server of a live page keeps others out, refuses what is malformed, lives on, and ends cleanly."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from chainbuild.cli.inspect import _open
from chainbuild.formats.load import load
from chainbuild.inspect.live.server import serve
from chainbuild.inspect.live.session import Session
from chainbuild.machines import shipped_path
from tests.kit.command_line import Run
from tests.kit.live_server import TOKEN, Server, Tab, frame

MACHINE = "kr6r900"
AXES = [0.0, -80.0, 80.0, 0.0, 30.0, 0.0]
PATIENCE_S = 5.0  # of an honest tab while others misbehave; measured 0.2 on a busy computer


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Return a server for all tests that leave it alive."""
    with Server(tmp_path_factory.mktemp("runtime"), MACHINE) as started:
        yield started
        with _reading(started):
            tab = started.tab()
            tab.send({"section": "rz"})
            code, out, err, seconds = started.end()
        assert (code, out) == (0, "")
        assert re.fullmatch(r"\d+ messages were refused\n", err)
        assert seconds < PATIENCE_S
        assert _left(started) == []


@contextmanager
def _reading(server: Server) -> Iterator[None]:
    """Have a server read a large file while the block runs: some ten seconds, if it were read to its end."""
    lines = b"$MC_ROBX_MAIN_LENGTH_AB[0]=1\n" * 500_000
    thread = threading.Thread(target=server.drop, args=["large", lines])
    thread.start()
    while not list(server.folder.glob("chainbuild-*/large")):
        time.sleep(0.02)
    yield
    thread.join()


def _left(server: Server) -> list[str]:
    """Return what is in the folders for temporary files beside the folder of the tokens."""
    return [one.name for one in server.folder.iterdir() if one.name != f"chainbuild-{os.getuid()}"]


@pytest.fixture
def tab(server: Server) -> Iterator[Tab]:
    """Return a tab that has been greeted."""
    made = server.tab()
    yield made
    made.close()


def test_listens_on_this_computer_alone(server: Server) -> None:
    """No other computer reaches the port, whatever its own address."""
    port = f"{server.port:04X}"
    listening = [
        line.split()[1]
        for table in ("tcp", "tcp6")
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]
        if line.split()[3] == "0A" and line.split()[1].endswith(f":{port}")
    ]
    assert listening == [f"0100007F:{port}"]


@pytest.mark.parametrize(
    "query",
    ["", "?token=", "?token=" + 16 * "x", f"?token={TOKEN[:-1]}", f"?token={TOKEN}x", f"?token={TOKEN}%20"]
    + [f"?token={TOKEN}&token={TOKEN}", f"?Token={TOKEN}", f"?token={TOKEN}%00"],
)
def test_token_is_needed(server: Server, query: str) -> None:
    """Without exactly one token that is the right one nothing is shown, taken or connected."""
    assert server.ask(f"GET /{query}")[0] == 403
    assert server.ask(f"POST /drop{query}", f"Origin: {server.origin}", body=b"x")[0] == 403
    assert server.upgrade(query, f"Origin: {server.origin}")[0] == 403


def test_foreign_origins_and_hosts_are_refused(server: Server) -> None:
    """A page elsewhere cannot connect, not even by a name of its own that leads here."""
    query = f"?token={TOKEN}"
    others = ["http://elsewhere.test", "null", f"https://{server.host}", f"http://127.0.0.1:{server.port + 1}"]
    for origin in others:
        assert server.ask(f"GET /{query}", f"Origin: {origin}")[0] == 403
        assert server.upgrade(query, f"Origin: {origin}")[0] == 403
    for host in ("elsewhere.test", f"elsewhere.test:{server.port}", "127.0.0.1", f"[::1]:{server.port}"):
        assert server.ask(f"GET /{query}", host=host)[0] == 403
        assert server.upgrade(query, f"Origin: http://{host}", host=host)[0] == 403
    assert server.ask(f"POST /drop{query}", body=b"x")[0] == 403  # no page has sent it
    local = f"localhost:{server.port}"
    assert server.upgrade(query, f"Origin: http://{local}", host=local)[0] == 101
    assert server.upgrade(query)[0] == 101  # no page, but somebody with the token


@pytest.mark.parametrize("path", ["/../", "/static/../x", "/..%2f..%2fetc/passwd", "//", "/etc/passwd", "/live/", "*"])
def test_there_is_nothing_else(server: Server, path: str) -> None:
    """No path leads to a file, and none tells whether a token is right."""
    assert server.ask(f"GET {path}?token={TOKEN}") == (404, "There is nothing here.\n")
    assert server.ask(f"GET http://{server.host}{path}")[0] == 404


def test_methods(server: Server) -> None:
    """What a page does not do is refused."""
    for method in ("HEAD", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "get", "X"):
        for path in ("/", "/live", "/drop"):
            assert server.ask(f"{method} {path}?token={TOKEN}")[0] in (403, 405), (method, path)


def test_page_is_kept_to_itself(server: Server) -> None:
    """The page may connect to its own address alone, and nothing keeps or frames it."""
    with server.connect() as connection:
        connection.sendall(f"GET /?token={TOKEN} HTTP/1.0\r\nHost: {server.host}\r\n\r\n".encode())
        answer = b""
        while part := connection.recv(65_536):
            answer += part
    head = answer.partition(b"\r\n\r\n")[0].decode().lower()
    assert "cache-control: no-store" in head
    assert "x-frame-options: deny" in head
    assert "server:" not in head
    assert f"connect-src http://{server.host} ws://{server.host}".encode() in answer


def test_large_contents_of_strangers_are_not_read(server: Server) -> None:
    """A body is refused before it is in memory: without token, too large, or where none is expected."""
    before = server.memory()
    large = bytes(16 * 1024 * 1024)
    for start in (f"POST /drop?token={TOKEN}x", "POST /", f"POST /live?token={TOKEN}"):
        assert server.ask(start, f"Origin: {server.origin}", body=large)[0] in (0, 400, 403)
    assert server.drop("x.mpf", large + b"x")[0] in (0, 400)
    assert server.memory() < before + 16


@pytest.mark.parametrize(
    "data",
    [
        frame(b"\xff\xfe"),  # no UTF-8
        frame("x", 0),  # continues nothing
        frame("x", 3),  # of no kind
        frame("x" * 200, 9),  # a ping that is too long
        frame("x", 8),
        frame(b"\x03\xe8\xff\xff", 8),
        frame("", length=1 << 62),
        frame(b" " * 1_100_000),
        frame("[", more=True) + frame("[", more=True),
    ],
)
def test_malformed_frames_end_the_connection(server: Server, data: bytes) -> None:
    """They end that of the tab alone; nothing is said in the terminal, which the end of the server shows."""
    made = server.tab()
    with pytest.raises((EOFError, ConnectionResetError)):
        made.raw(data)
        while made.frame()[0] != 1:
            pass
    made.close()
    server.tab().close()


def test_refused_messages_are_told_and_counted(server: Server, tab: Tab) -> None:
    """Each of them; the connection stays."""
    count = None
    for text in (
        "",
        "NaN",
        '{"axes":[0]}',
        b"\x01",
        " " * 65_537,
        "[" * 60_000,
        '{"datum":{"key":"\\ud800","value":1}}',
    ):
        tab.raw(frame(text, 2 if isinstance(text, bytes) else 1))
        told = tab.take("refused")
        assert told["text"]
        assert count is None or told["count"] == count + 1
        count = told["count"]
    assert told["key"] == "\ud800"


def _honest(server: Server, axes: list[float] = AXES) -> None:
    """Assert that another tab is served."""
    began = time.monotonic()
    made = server.tab()
    made.send({"axes": axes})
    made.take("contacts")
    made.close()
    assert time.monotonic() - began < PATIENCE_S


@pytest.mark.parametrize(
    "message",
    [
        {"axes": AXES},
        {"ask": {"id": 1, "fk": AXES}},
        {"moves": "TX3P3_POS[0]"},
        {"datum": {"key": "TX3P3_POS[0]", "value": 1.0}},
        {"model": None},
        {"section": "rz"},
        {"nothing": 1},
    ],
    ids=lambda message: next(iter(message)),
)
def test_burst_of_a_tab_that_never_reads(server: Server, message: dict[str, object]) -> None:
    """Ten thousand messages neither pile up nor keep others waiting, not even those of a tab that has gone."""
    before = server.memory()
    made = server.tab()
    made.connection.settimeout(0.5)
    with suppress(TimeoutError):  # it may read no more before its answers are read
        made.raw(10_000 * frame(json.dumps(message)))
    _honest(server)
    made.close()
    _honest(server)
    assert server.memory() < before + 32
    tab = server.tab()
    tab.send({"reset": None})
    tab.take("model")
    tab.close()


def test_last_axes_of_a_burst_reach_every_tab(server: Server, tab: Tab) -> None:
    """The last value wins, in the session and in every tab, even if several move the machine at once."""
    tabs = [server.tab() for _ in range(3)]
    for n in range(2000):
        tabs[n % 2].send({"axes": [n / 100, *AXES[1:]]})
    settled = []
    for one in (*tabs, tab):  # also who has sent it: it may have been told another one meanwhile
        while (told := one.take("axes"))["by"]:
            pass
        settled.append(told["axes"])
    assert settled[0] in ([19.98, *AXES[1:]], [19.99, *AXES[1:]])
    assert settled == 4 * [server.upgrade(f"?token={TOKEN}")[1].take("hello")["axes"]]
    for one in tabs:
        one.close()


def test_a_section_keeps_its_tab_from_nothing(server: Server, tab: Tab) -> None:
    """While it is computed the tab that has asked for it moves the machine, and asks."""
    tab.send({"section": "rz"})
    tab.send({"ask": {"id": 7, "fk": AXES}})
    tab.send({"moves": "TX3P3_POS[0]"})
    seen: list[str] = []
    while "section" not in seen:
        seen += json.loads(tab.frame()[1])
    assert {"answer", "moves"} < set(seen)


def test_many_tabs(server: Server) -> None:
    """More than a hundred, opened and closed, are forgotten."""
    server.tab().close()
    before = server.memory()
    tabs = [server.upgrade(f"?token={TOKEN}")[1] for _ in range(60)]
    for one in tabs:
        one.close()
    for _ in range(60):
        server.upgrade(f"?token={TOKEN}")[1].close()
    _honest(server)
    assert server.memory() < before + 32


NAMES = ["../../x", "..", "", "%00", "a" * 10_000, "%F0%9F%98%80" * 200, "C:%5Cx.mpf"]


@pytest.mark.parametrize("name", NAMES, ids=lambda name: name[:20] or "none")
def test_dropped_files_of_any_name(server: Server, name: str) -> None:
    """What a name says leads nowhere; the machine is shown in every tab, and can be changed."""
    path = shipped_path("irb2600")
    assert path is not None
    tab = server.tab()
    assert server.drop(name, path.read_bytes()) == (200, "{}")
    tab.take("hello")
    tab.send({"datum": {"key": "MAIN_LENGTH_AB[0]", "value": 500.0}})
    assert tab.take("model")["live"]["values"] == {"MAIN_LENGTH_AB[0]": 500.0}
    tab.close()
    assert _left(server) == []


@pytest.mark.parametrize(
    "content",
    [b"", bytes(1000), b"a,b\n1,2\n", b"[x]\ny=1\n", b"$MC_ROBX_MAIN_LENGTH_AB[0]=z\n$MC_TRAFO_TYPE_1=4099\n"]
    + [b"<?xml version='1.0'?><a>", b"PK\x03\x04\x00", b"x" * (16 * 1024 * 1024)],
    ids=["empty", "binary", "csv", "toml", "errors", "xml", "zip", "large"],
)
def test_dropped_files_that_are_no_machine(server: Server, content: bytes) -> None:
    """They are refused in words, which name the file and not where it was put; the session stays."""
    hello = server.upgrade(f"?token={TOKEN}")[1].take("hello")
    status, answer = server.drop("a%20file.mpf", content)
    assert status == 200
    assert json.loads(answer)["refused"].startswith("a file.mpf")
    assert server.upgrade(f"?token={TOKEN}")[1].take("hello") == hello


def test_killed_and_started_again(tmp_path: Path, run: Run) -> None:
    """On the same port it has the same token, which its owner alone can read; it ends at once while it is busy."""
    with Server(tmp_path, "scara_kin36", token=None) as first:
        [kept] = tmp_path.glob("*/*")
        assert (kept.stat().st_mode & 0o777, kept.parent.stat().st_mode & 0o777) == (0o600, 0o700)
        assert kept.read_text() == first.token
        tab = first.tab()
        assert first.end(signal.SIGKILL)[0] == -signal.SIGKILL
        tab.close()
    with Server(tmp_path, "scara_kin36", port=first.port, token=None) as second:
        assert second.token == first.token
        outcome = run("inspect", "scara_kin36", "--no-open", "--port", str(first.port))
        assert (outcome.code, outcome.out) == (1, "")
        assert f"port {first.port} is in use" in outcome.err
        with _reading(second):
            _honest(second, [0.0, 0.0, 0.0, 0.0])
            code, out, err, seconds = second.end(signal.SIGTERM)
        assert (code, out, err) == (-signal.SIGTERM, "", "chainbuild: terminated\n")
        assert seconds < PATIENCE_S
        assert _left(second) == []


@pytest.mark.parametrize("port", ["-1", "65536", "99999999999999999999"])
def test_ports_that_do_not_exist(run: Run, port: str) -> None:
    """They are refused, and not taken for others."""
    outcome = run("inspect", "scara_kin36", "--no-open", "--port", port)
    assert outcome.code == 1
    assert f"port {port}" in outcome.err


def test_options_that_are_refused(run: Run, tmp_path: Path) -> None:
    """A token that is guessed, and an exported page with a server."""
    for token in ("short", "a b" * 8, "a" * 129, "é" * 16):
        assert run("inspect", "scara_kin36", "--no-open", "--token", token).code == 1
    for words in (["--no-open"], ["--port", "0"], ["--token", TOKEN], ["--beside", MACHINE]):
        outcome = run("inspect", "scara_kin36", "--export", tmp_path / "page.html", *words)
        assert outcome.code == 2
        assert words[0] in outcome.err


def test_nobody_can_be_told_the_address() -> None:
    """The server ends when standard output takes nothing, and no thread of it stays."""

    def ready(_address: str, _end: Callable[[], None]) -> None:
        raise BrokenPipeError

    with pytest.raises(BrokenPipeError):
        serve(Session(load("scara_kin36")), ready, port=0, token=TOKEN)
    assert {"session", "section", "questions", "file"}.isdisjoint(one.name for one in threading.enumerate())


def test_browser_that_shows_the_page_before_it_returns(monkeypatch: pytest.MonkeyPatch) -> None:
    """The page is served while the browser is started."""
    shown = threading.Event()
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(webbrowser, "open", lambda _address: shown.wait(PATIENCE_S))
    began = time.monotonic()
    _open("http://127.0.0.1:7421/")
    assert time.monotonic() - began < PATIENCE_S / 2
    shown.set()


def test_server_needs_no_notebook_and_no_tunnel() -> None:
    """What draws loads neighbours of its own; the server loads none of them."""
    words = (
        "import sys, chainbuild.inspect.live.server; print({'IPython', 'zmq', 'pyngrok', 'meshcat'} & set(sys.modules))"
    )
    result = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert result.stdout == "set()\n"
