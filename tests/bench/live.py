"""Questions of a live page to Python: time of a round trip; `python -m tests.bench.live` writes the table."""

from __future__ import annotations

import asyncio
import json
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

from tornado.websocket import websocket_connect

import chainbuild
from tests.bench.tables import markdown
from tests.kit.live_server import Server

# Axis values within the limits and away from singular positions.
MACHINES = {
    "kr6r900": (10.0, -60.0, 80.0, 30.0, 40.0, 20.0),
    "tx2_60": (10.0, -60.0, 80.0, 30.0, 40.0, 20.0),
    "irb2600": (10.0, 20.0, 30.0, 30.0, 40.0, 20.0),
}
MARK = "5 ms, median, for fk, ik and ik_all"
ROUNDS = 300  # questions of each kind
_AWAY = 10.0  # degrees by which every axis stands elsewhere when the pose is asked for


async def _times(address: str, questions: list[dict[str, Any]]) -> list[list[float]]:
    """Return the times of round trips [ms] by question."""
    socket = await websocket_connect(address.replace("http:", "ws:").replace("/?", "/live?"))
    found = []
    for question in questions:
        times = []
        for n in range(ROUNDS + 10):
            start = time.perf_counter()
            await socket.write_message(json.dumps({"ask": {"id": n, **question}}))
            while True:
                message = await socket.read_message()
                assert message is not None
                if json.loads(message).get("answer", {}).get("id") == n:
                    break
            times.append(1000.0 * (time.perf_counter() - start))
        found.append(times[10:])  # the first ones load and compile
    socket.close()
    return found


def measured(name: str) -> tuple[object, ...]:
    """Return a machine's name, its branches, and by question the median and the 95 % of the times [ms]."""
    robot = chainbuild.Robot.load(name)
    axes = MACHINES[name]
    start = [value - _AWAY for value in axes]
    flat = robot.fk(axes).homogeneous.ravel().tolist()
    questions: list[dict[str, Any]] = [
        {"fk": list(axes)},
        {"ik": flat, "start": start},
        {"ik_all": flat, "start": start},
    ]
    with tempfile.TemporaryDirectory() as folder, Server(Path(folder), name) as server:
        times = asyncio.run(_times(server.address, questions))
    shown = [f"{value:.2f}" for one in times for value in (statistics.median(one), statistics.quantiles(one, n=20)[-1])]
    return name, len(robot.ik_all(robot.fk(axes), axes)), *shown


def report() -> str:
    """Return the table as Markdown."""
    head = ("machine", "branches", *(f"{what}, {how}" for what in ("fk", "ik", "ik_all") for how in ("median", "95 %")))
    return f"# Questions of the live page\n\nRound trips in ms. Mark: {MARK}.\n\n" + markdown(
        head, [measured(name) for name in MACHINES]
    )


if __name__ == "__main__":
    text = report()
    Path(__file__).with_suffix(".md").write_text(text, "utf-8")
    print(text)
