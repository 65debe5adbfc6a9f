"""A live page that is served, in a thread of the test or in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
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


class ServerProcess:
    """`chainbuild inspect` in a process of its own.

    Args:
        words: Words of the command line after `inspect`.
        runtime: Folder for its token.

    Attributes:
        address: Of the page.
    """

    def __init__(self, words: list[str], runtime: Path) -> None:
        command = [sys.executable, "-m", "chainbuild", "inspect", "--no-open", *words]
        environment = {**os.environ, "XDG_RUNTIME_DIR": str(runtime)}
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self.address.split(":")[2].split("/")[0])

    def kill(self) -> None:
        """End it without a word."""
        self.process.kill()
        self.process.communicate()
