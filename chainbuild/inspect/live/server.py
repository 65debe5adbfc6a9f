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
_ADDRESS: Final = "127.0.0.1"
_LARGEST_FILE: Final = 16 * 1024 * 1024  # bytes of a machine file that is dropped; archives have a few million
_PING_S: Final = 20  # seconds between two signs of life of a tab


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
    return asyncio.run(_serving(session, sockets, token, ready))


async def _serving(
    session: Session, sockets: list[socket.socket], token: str, ready: Callable[[str, Callable[[], None]], None]
) -> int:
    from tornado.httpserver import HTTPServer
    from tornado.web import Application

    from chainbuild.inspect.live.handlers import DropHandler, LiveHandler, NothingHandler, PageHandler

    _quieten()
    hub = Hub(session)
    port = sockets[0].getsockname()[1]
    given = {"hub": hub, "token": token, "port": port}
    application = Application(
        [("/", PageHandler, given), ("/live", LiveHandler, given), ("/drop", DropHandler, given)],
        default_handler_class=NothingHandler,
        default_handler_args=given,
        log_function=lambda _handler: None,
        websocket_max_message_size=LARGEST_MESSAGE,
        websocket_ping_interval=_PING_S,
        websocket_ping_timeout=_PING_S,
        compress_response=False,
    )
    server = HTTPServer(application, max_body_size=_LARGEST_FILE, max_buffer_size=_LARGEST_FILE + LARGEST_MESSAGE)
    server.add_sockets(sockets)
    over = asyncio.Event()
    loop = asyncio.get_running_loop()
    with suppress(NotImplementedError, RuntimeError, ValueError):  # Windows; another thread than the first
        loop.add_signal_handler(signal.SIGINT, over.set)

    def end() -> None:
        loop.call_soon_threadsafe(over.set)

    try:
        ready(f"http://{_ADDRESS}:{port}/?token={token}", end)
        await over.wait()
    finally:
        server.stop()
        hub.close()
    return hub.refused


def _sockets(port: int | None) -> list[socket.socket]:
    """Return sockets that listen on a port of this computer, and are not reached from others."""
    from tornado.netutil import bind_sockets

    wanted = [port] if port is not None else [*range(FIRST_PORT, FIRST_PORT + _PORTS), 0]
    for number in wanted:
        try:
            return bind_sockets(number, _ADDRESS)
        except OSError as error:
            if port is None and error.errno in (errno.EADDRINUSE, errno.EACCES):
                continue
            what = "is in use" if error.errno == errno.EADDRINUSE else f"is refused: {error.strerror}"
            raise ChainbuildError(f"port {number} {what}", parameter="--port", hint="choose another port") from None
        except OverflowError:
            break
    raise ChainbuildError(f"port {port}", parameter="--port", permitted="0 … 65535; 0: any free one")


def _quieten() -> None:
    """Keep what strangers send out of the terminal: it is refused and counted."""
    for name in ("tornado.access", "tornado.general"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
