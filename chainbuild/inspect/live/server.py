"""The server of a live page, for this computer alone."""

from __future__ import annotations

import asyncio
import errno
import logging
import signal
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from chainbuild.errors import ChainbuildError
from chainbuild.inspect.live.hub import Hub
from chainbuild.inspect.live.messages import LARGEST_MESSAGE
from chainbuild.inspect.live.tokens import keep_token, token_for

if TYPE_CHECKING:
    import socket

    from chainbuild.inspect.live.session import Session

FIRST_PORT: Final = 7421  # any that is rarely used; the same again, so that a page finds the server after a restart
_PORTS: Final = 20  # looked at before any free one is taken
_LAST_PORT: Final = 65_535  # of TCP
_ADDRESS: Final = "127.0.0.1"
_LARGEST_FRAME: Final = 16 * LARGEST_MESSAGE  # bytes: what is larger than a message is refused in words, not cut off
_LARGEST_BODY: Final = 1024  # bytes: only a file that is dropped has more, and asks for it when it has shown its token


def serve(
    session: Session,
    ready: Callable[[str, Callable[[], None]], None],
    *,
    port: int | None = None,
    token: str | None = None,
) -> int:
    """Serve a live page until the process is interrupted, or somebody ends it.

    Args:
        session: What it shows.
        ready: Called when the server listens: with the address of the page, and with what ends the server from any
            thread.
        port: Port; None: the first free one from 7421.
        token: Token; None: that of the port from an earlier run, else a new one.

    Returns:
        How many messages were refused.

    Raises:
        ChainbuildError: the port is in use or not permitted.
    """
    sockets = _sockets(port)
    number = sockets[0].getsockname()[1]
    if token is None:
        token = token_for(number)
    else:
        keep_token(number, token)
    ended: list[int] = []
    before = {name: signal.getsignal(name) for name in _signals()}
    try:
        return asyncio.run(_serving(session, sockets, token, ready, ended))
    finally:
        with suppress(ValueError, TypeError):  # another thread than the first; a handler that is not Python's
            for name, handler in before.items():
                signal.signal(name, handler)
        # What ends a process ends this one, too, now that nothing is left behind.
        for number in ended:
            if number != signal.SIGINT:
                signal.raise_signal(number)


def _signals() -> list[signal.Signals]:
    """Return the signals that end the server, without those that are not to reach this process."""
    known = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    return [signal.SIGINT, *(one for one in known if signal.getsignal(one) is not signal.SIG_IGN)]


async def _serving(
    session: Session,
    sockets: list[socket.socket],
    token: str,
    ready: Callable[[str, Callable[[], None]], None],
    ended: list[int],
) -> int:
    from tornado.httpserver import HTTPServer
    from tornado.web import Application

    from chainbuild.inspect.live.handlers import DropHandler, LiveHandler, NothingHandler, PageHandler

    _silence("tornado.access", "tornado.general")  # what strangers send is refused and counted
    hub = Hub(session)
    port = sockets[0].getsockname()[1]
    given = {"hub": hub, "token": token, "port": port}
    application = Application(
        [("/", PageHandler, given), ("/live", LiveHandler, given), ("/drop", DropHandler, given)],
        default_handler_class=NothingHandler,
        default_handler_args=given,
        log_function=lambda _handler: None,
        websocket_max_message_size=_LARGEST_FRAME,
        compress_response=False,
    )
    server = HTTPServer(application, max_body_size=_LARGEST_BODY, max_buffer_size=2 * _LARGEST_FRAME)
    server.add_sockets(sockets)
    over = asyncio.Event()
    loop = asyncio.get_running_loop()

    def end(number: int) -> None:
        ended.append(number)
        over.set()

    def stop() -> None:
        loop.call_soon_threadsafe(over.set)

    with suppress(NotImplementedError, RuntimeError, ValueError):  # Windows; another thread than the first
        for number in _signals():
            loop.add_signal_handler(number, end, number)
    try:
        ready(f"http://{_ADDRESS}:{port}/?token={token}", stop)
        await over.wait()
    finally:
        server.stop()
        _silence("tornado.application", "asyncio", "concurrent.futures")  # what is given up is no fault
        await hub.close()
    return hub.refused


def _sockets(port: int | None) -> list[socket.socket]:
    """Return sockets that listen on a port of this computer, and are not reached from others."""
    from tornado.netutil import bind_sockets

    if port is not None and not 0 <= port <= _LAST_PORT:
        raise ChainbuildError(f"port {port}", parameter="--port", permitted=f"0 … {_LAST_PORT}; 0: any free one")
    wanted = [port] if port is not None else [*range(FIRST_PORT, FIRST_PORT + _PORTS), 0]
    for number in wanted:
        try:
            return bind_sockets(number, _ADDRESS)
        except OSError as error:
            if port is None and error.errno in (errno.EADDRINUSE, errno.EACCES):
                continue
            what = "is in use" if error.errno == errno.EADDRINUSE else f"is refused: {error.strerror}"
            raise ChainbuildError(f"port {number} {what}", parameter="--port", hint="choose another port") from None
    raise ChainbuildError("no port is free", parameter="--port", hint="choose one")


def _silence(*names: str) -> None:
    """Keep what is logged under some names out of the terminal."""
    for name in names:
        logging.getLogger(name).disabled = True
