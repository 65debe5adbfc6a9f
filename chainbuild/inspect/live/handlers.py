"""What the server of a live page answers: the page, its connection, a file that is dropped on it; nothing else."""

from __future__ import annotations

import hmac
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote

from tornado.web import HTTPError, RequestHandler, stream_request_body
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from chainbuild.errors import ChainbuildError
from chainbuild.inspect.live.hub import in_words

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from chainbuild.inspect.live.hub import Hub, Tab

HOSTS: Final = ("127.0.0.1", "localhost")
LARGEST_FILE: Final = 16 * 1024 * 1024  # bytes of a machine file that is dropped; archives have a few million
_USUAL_PORT: Final = 80  # of a web server: browsers leave it out


class _Guarded(RequestHandler):
    """Lets in only who has the token and asks for this server by its own name."""

    def initialize(self, hub: Hub, token: str, port: int) -> None:
        """Store what every handler needs."""
        self.hub = hub
        self._token = token
        self._hosts = tuple(name if port == _USUAL_PORT else f"{name}:{port}" for name in HOSTS)

    def prepare(self) -> None:
        """Refuse a foreign host, a foreign page, a wrong token."""
        # A page elsewhere may have its own name lead here: it then asks by that name.
        if self.request.host not in self._hosts or not self.is_ours(self.request.headers.get("Origin")):
            raise HTTPError(403)
        given = self.get_query_arguments("token", strip=False)
        if len(given) != 1 or not hmac.compare_digest(given[0].encode(), self._token.encode()):
            raise HTTPError(403)

    def is_ours(self, origin: str | None) -> bool:
        """Tell whether a request comes from a page of this server, or from none."""
        return origin is None or origin in tuple(f"http://{host}" for host in self._hosts)

    def set_default_headers(self) -> None:
        """Keep the page to itself: no cache, no frame elsewhere, no address told to others."""
        self.set_header("Cache-Control", "no-store")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("X-Frame-Options", "DENY")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.clear_header("Server")

    def write_error(self, status_code: int, **_details: Any) -> None:
        """Say in a line why nothing is shown."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        words = {403: "The address is incomplete: chainbuild prints it with its token.", 404: "There is nothing here."}
        self.finish(words.get(status_code, f"Refused ({status_code}).") + "\n")


class PageHandler(_Guarded):
    """The page."""

    async def get(self) -> None:
        """Answer with the page."""
        host = self.request.host
        self.finish(await self.hub.page(f"http://{host} ws://{host}"))


@stream_request_body
class DropHandler(_Guarded):
    """A machine file that was dropped on the page; whoever has no token is refused before its content is read."""

    def prepare(self) -> None:
        """Refuse what comes from no page, and permit a large file."""
        super().prepare()
        if self.request.headers.get("Origin") is None:
            raise HTTPError(403)
        self._content = bytearray()
        connection: Any = self.request.connection
        connection.set_max_body_size(LARGEST_FILE)

    def data_received(self, chunk: bytes) -> None:
        """Keep a part of the file."""
        self._content += chunk

    async def post(self) -> None:
        """Show the machine of the file; what is refused is told in words."""
        name = unquote(self.request.headers.get("X-File-Name", ""))
        try:
            await self.hub.opened(name, bytes(self._content))
        except ChainbuildError as error:
            # Not an error of HTTP: browsers write those to their console.
            self.finish({"refused": in_words(error)})
        else:
            self.finish({})


class NothingHandler(_Guarded):
    """Every other address."""

    def prepare(self) -> None:
        """Refuse it."""
        raise HTTPError(404)


class LiveHandler(_Guarded, WebSocketHandler):
    """The connection of a tab."""

    _tab: Tab | None = None

    def check_origin(self, origin: str) -> bool:
        """Refuse pages of others."""
        return self.is_ours(origin)

    async def open(self, *_arguments: str, **_named: str) -> None:
        """Take up the tab."""
        self.set_nodelay(True)
        self._tab = self.hub.joined(self)
        await self.hub.greet(self._tab)

    def on_message(self, message: str | bytes) -> Awaitable[None] | None:
        """Take a message; the next is read when this one has found room, so that they do not pile up here."""
        return None if self._tab is None else self.hub.told(self._tab, message)

    async def send(self, text: str) -> None:
        """Send a text, unless the tab has been closed."""
        try:
            await self.write_message(text)
        except WebSocketClosedError:
            self.on_close()

    def on_close(self) -> None:
        """Forget the tab."""
        if self._tab is not None:
            self.hub.left(self._tab)
