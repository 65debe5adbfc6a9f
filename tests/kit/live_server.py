"""A live page's server as a process of its own, and what talks to it byte by byte."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Any, Self

from tests.kit.command_line import PROGRAM

TOKEN = "a-token-of-the-tests"


class Tab:
    """A WebSocket connection; what it sends is masked with zeros, and so is legible."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection

    def send(self, message: object) -> None:
        """Send a message as JSON, or a text as it is."""
        self.raw(frame(message if isinstance(message, str | bytes) else json.dumps(message)))

    def raw(self, data: bytes) -> None:
        """Send bytes."""
        self.connection.sendall(data)

    def _exactly(self, count: int) -> bytes:
        found = b""
        while len(found) < count:
            part = self.connection.recv(count - len(found))
            if not part:
                raise EOFError
            found += part
        return found

    def frame(self) -> tuple[int, bytes]:
        """Return the kind and the content of the next frame."""
        head, length = self._exactly(2)
        if length == 126:
            length = int.from_bytes(self._exactly(2), "big")
        elif length == 127:
            length = int.from_bytes(self._exactly(8), "big")
        return head & 15, self._exactly(length)

    def take(self, kind: str) -> Any:
        """Return the content of the next message of a kind; those before it are passed over."""
        while True:
            code, content = self.frame()
            assert code == 1, f"frame {code}: {content[:80]!r}"
            message = json.loads(content)
            if kind in message:
                return message[kind]

    def close(self) -> None:
        """Close the connection without a word."""
        self.connection.close()


def frame(content: str | bytes, code: int = 1, *, more: bool = False, length: int | None = None) -> bytes:
    """Return a frame of a client."""
    data = content.encode() if isinstance(content, str) else content
    size = len(data) if length is None else length
    long = bytes([0x80 | size]) if size < 126 else b"\xff" + size.to_bytes(8, "big")
    return bytes([code if more else 0x80 | code]) + long + bytes(4) + data


class Server:
    """A server, started with a machine."""

    def __init__(self, folder: Path, machine: str, *more: str, port: int = 0, token: str | None = TOKEN) -> None:
        self.folder = folder
        words = [machine, "--no-open", "--port", str(port), *more]
        self.process = subprocess.Popen(
            [*PROGRAM, "inspect", *words, *([] if token is None else ["--token", token])],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "XDG_RUNTIME_DIR": str(folder), "TMPDIR": str(folder)},
        )
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=(.*)", self.address)
        assert found, self.process.communicate()
        self.port, self.token = int(found[1]), found[2]
        self.host = f"127.0.0.1:{self.port}"
        self.origin = f"http://{self.host}"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def connect(self) -> socket.socket:
        """Return a connection."""
        return socket.create_connection(("127.0.0.1", self.port), timeout=10)

    def ask(self, start: str, *heads: str, host: str | None = None, body: bytes = b"") -> tuple[int, str]:
        """Return the status and the content of the answer to a request: `"GET /"`; status 0: there was none."""
        method, _, path = start.partition(" ")
        lines = [f"{method} {path} HTTP/1.1", f"Host: {self.host if host is None else host}", *heads]
        if body or method == "POST":
            lines.append(f"Content-Length: {len(body)}")
        with self.connect() as connection:
            answer = b""
            try:
                connection.sendall("\r\n".join([*lines, "Connection: close", "", ""]).encode("latin1") + body)
                while part := connection.recv(65_536):
                    answer += part
            except (BrokenPipeError, ConnectionResetError):
                pass  # what is refused is not read to its end
        head, _, content = answer.partition(b"\r\n\r\n")
        return int(head.split()[1]) if head else 0, content.decode()

    def drop(self, name: str, content: bytes) -> tuple[int, str]:
        """Drop a file on the page."""
        heads = (f"Origin: {self.origin}", f"X-File-Name: {name}")
        return self.ask(f"POST /drop?token={self.token}", *heads, body=content)

    def upgrade(self, query: str, *heads: str, host: str | None = None) -> tuple[int, Tab]:
        """Return the status of the answer to a wish for a WebSocket, and its connection."""
        connection = self.connect()
        upgrade = (
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " + 22 * "A"
        )
        lines = [f"GET /live{query} HTTP/1.1", f"Host: {self.host if host is None else host}", upgrade + "==", *heads]
        connection.sendall("\r\n".join([*lines, "", ""]).encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += connection.recv(1) or b"\r\n\r\n"
        return int(head.split()[1]), Tab(connection)

    def tab(self) -> Tab:
        """Return a tab that has been greeted."""
        status, tab = self.upgrade(f"?token={self.token}", f"Origin: {self.origin}")
        assert status == 101
        tab.take("contacts")
        return tab

    def memory(self) -> int:
        """Return the resident memory of the process, MB."""
        text = Path(f"/proc/{self.process.pid}/status").read_text()
        found = re.search(r"VmRSS:\s+(\d+)", text)
        assert found
        return int(found[1]) // 1024

    def end(self, number: signal.Signals = signal.SIGINT) -> tuple[int, str, str, float]:
        """End the server; return its exit code, what else it has written to both streams, and how long it took."""
        began = time.monotonic()
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=30)
        return self.process.returncode, out, err, time.monotonic() - began
