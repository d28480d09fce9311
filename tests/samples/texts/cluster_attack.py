"""What a stranger tries on the ports of a cluster: `python cluster_attack.py MARK SECONDS PORT…` prints what it
could do, waiting so long for each answer.
"""

import asyncio
import os
import pickle
import sys
import urllib.request
from pathlib import Path

from distributed import Security
from distributed.comm import connect
from distributed.core import Server, send_recv

NOBODY = 65534


def left_mark(path: str) -> None:
    with Path(path).open("a") as file:
        file.write("here\n")


class Bomb:
    """Leaves a mark when it is unpickled."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __reduce__(self) -> tuple:
        return left_mark, (self.path,)


async def asked(address: str, mark: str, seconds: float, **security: object) -> bool:
    """Whether anything was answered; a scheduler and a worker know different words, so each is a try of its own."""
    job = {"function": pickle.dumps(left_mark), "args": pickle.dumps((mark,)), "kwargs": pickle.dumps({})}
    answered = False
    for message in ({"op": "identity"}, {"op": "run", **job}, {"op": "run_function", **job, "wait": True}):
        try:
            comm = await asyncio.wait_for(connect(address, timeout=seconds, **security), seconds)
            await asyncio.wait_for(send_recv(comm, **message), seconds)
        except Exception:
            continue
        answered = True
    return answered


def page_of(port: str, seconds: float) -> bool:
    for page in ("", "info/main/workers.html", "json/counts.json", "metrics", "sysinfo", "health"):
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{port}/{page}", timeout=seconds)
        except Exception:
            continue
        return True
    return False


async def rehearse() -> None:
    """Ask a server of one's own: what is imported by the way may lie where the other user can't read."""
    async with Server({}) as server:
        await server.listen("tcp://127.0.0.1:0")
        comm = await connect(server.address)
        await send_recv(comm, op="identity")
        await comm.close()


def become_another_user() -> None:
    """Where that is allowed; the interpreter may lie where the other user couldn't start it."""
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)


async def main(mark: str, patience: str, *ports: str) -> None:
    seconds = float(patience)
    own = Security.temporary().get_connection_args("client")
    await rehearse()
    become_another_user()

    async def answered(port: str) -> bool:
        return (
            await asked(f"tcp://127.0.0.1:{port}", mark, seconds)
            or await asked(f"tls://127.0.0.1:{port}", mark, seconds, **own)
            or await asyncio.to_thread(page_of, port, seconds)
        )

    for port, done in zip(ports, await asyncio.gather(*map(answered, ports)), strict=True):
        if done:
            print(port)


if __name__ == "__main__":
    # Under a name by which workers find what they are sent.
    import cluster_attack

    asyncio.run(cluster_attack.main(*sys.argv[1:]))
