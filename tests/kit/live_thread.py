"""A live page that is served in a thread of the test."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Queue

from chainbuild.inspect.live.server import serve
from chainbuild.inspect.live.session import Session

TOKEN = "a-token-of-the-tests-0123456789"
_PATIENCE = 60.0  # seconds until a server that does not come up fails its test


@contextmanager
def served(session: Session) -> Iterator[str]:
    """Serve a session in a thread; gives the address of its page."""
    started: Queue[tuple[str, Callable[[], None]]] = Queue()
    thread = threading.Thread(
        target=lambda: serve(session, lambda address, end: started.put((address, end)), port=0, token=TOKEN)
    )
    thread.start()
    address, end = started.get(timeout=_PATIENCE)
    try:
        yield address
    finally:
        end()
        thread.join(_PATIENCE)
        assert not thread.is_alive()
