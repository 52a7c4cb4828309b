"""Opens labs: connects to a server, or starts a private one. evod.connection is generated from this file.

Threads      call everything on the event loop on which connect() or local() ran.
"""
from __future__ import annotations

import os
import weakref

from evod import local_server
from evod.aio.awaitable import opens
from evod.aio.lab import Lab
from evod.aio.link import Link, blocking_call
from evod.core import Core
from evod.endpoint import Endpoint, read_token, tls_context
from evod.experiment import Experiment
from evod.v1 import session_pb2


@opens
async def connect(
    server: str = "localhost",
    *,
    token: str | None = None,
    token_file: str | None = None,
    tls: bool = False,
    ca: str | None = None,
    cert: str | None = None,
    key: str | None = None,
    timeout_s: float = 30.0,
    reconnect: bool = True,
    client_name: str = "evod for Python",
) -> Lab:
    """Connects to a server.

    Parameters
    ----------
    server
        HOST, HOST:PORT or [IPV6]:PORT; the default port is 7744.
    token, token_file
        The access token, or a file that contains it and that only its owner can read. If neither is given, the token is
        read from the environment variable EVOD_TOKEN.
    tls
        Use TLS. The server must have a certificate that this system trusts.
    ca
        Use TLS, and trust the certificates in this PEM file, such as the server's own evod.crt. If it is not given, the
        file named by the environment variable EVOD_CA is used.
    cert, key
        Use TLS with this client certificate and its private key, for servers that require one. Both are PEM files; one
        file may contain both.
    timeout_s
        The longest time in seconds to wait for an answer, and for a server that cannot be reached. After this time,
        calls fail. Calls for which the server must replay a run may take 20 times as long.
    reconnect
        Whether to reconnect after the connection was lost.
    client_name
        The name of this program in the server's log.

    Raises
    ------
    NoConnection
        No server answers at this address, or the server refuses this client.
    DamagedData
        The program at this address is not an evod server.

    Examples
    --------
    >>> import evod.aio
    >>> async with evod.aio.local() as server:  # in place of your own server
    ...     async with evod.aio.connect(server.address) as lab:
    ...         lab.role, [world.name for world in await lab.worlds()]
    ('admin', ['default'])
    """
    endpoint = Endpoint.parse(server)
    core = Core(token=read_token(token, token_file), client_name=client_name, server=endpoint)
    link = Link(endpoint, core, tls_context(tls, ca, cert, key), timeout_s=timeout_s, reconnect=reconnect)
    await link.open()
    return Lab(link)


@opens
async def join(
    server: str,
    code: str,
    name: str | None = None,
    *,
    tls: bool = False,
    ca: str | None = None,
    timeout_s: float = 30.0,
    reconnect: bool = True,
    client_name: str = "evod for Python",
) -> Lab:
    """Connects as a member of a class: with its code as a new member, with a personal code as the member to whom it
    belongs. After the connection was lost, the lab comes back as the same member.

    Parameters
    ----------
    server, tls, ca, timeout_s, reconnect, client_name
        The same as for `connect`.
    code
        The letters of the code; upper and lower case are equal.
    name
        The name of a new member: at most 24 characters. By default the server makes one up.

    Returns
    -------
    Lab
        `Lab.membership` contains the name of the member's world.

    Raises
    ------
    NoConnection
        No server answers at this address, or no member can join, for example because another one has the name.
    Unauthenticated
        No open class has the code.

    Examples
    --------
    >>> import evod.aio
    >>> async with evod.aio.local() as teacher:
    ...     bio2 = await teacher.create_class("bio2")
    ...     async with evod.aio.join(teacher.address, await bio2.open(), "Ada") as lab:
    ...         world = await lab.world(lab.membership.world)
    ...         note = await world.note("more food, more organisms", kind="prediction")
    ...     (member,) = await bio2.members()
    >>> world.name, member.name, member.joined
    ('bio2_ada', 'Ada', True)
    """
    endpoint = Endpoint.parse(server)
    core = Core(join=session_pb2.Join(code=code, name=name or ""), client_name=client_name, server=endpoint)
    link = Link(endpoint, core, tls_context(tls, ca, None, None), timeout_s=timeout_s, reconnect=reconnect)
    await link.open()
    return Lab(link)


@opens
async def local(
    *,
    seed: int | None = None,
    experiment: Experiment = None,
    data: str | os.PathLike[str] | None = None,
    speed: float | str = "max",
    threads: int | None = None,
    program: str | os.PathLike[str] | None = None,
    timeout_s: float = 30.0,
) -> LocalLab:
    """Starts a private server at a free port and connects to it. Its page is at another free port: `World.show`.

    The server stops when the lab is closed or garbage collected, and when this program ends, even if it is killed.

    Parameters
    ----------
    seed
        Seed of the first world, 0 to 2**64 - 1. By default the server draws a random seed.
    experiment
        Parameters of the first world: an experiment file, or a mapping of names to values. By default all parameters
        have their default values.
    data
        Folder for the run files. By default a temporary folder, which is deleted when the server stops.
    speed
        Speed of every world, including worlds, forks and replays created later: simulated seconds per second, or "max"
        for as fast as the machine allows.
    threads
        Number of threads for the simulation. By default one for each processor.
    program
        Path of the program evod. By default the path in the environment variable EVOD, or else the evod found in PATH.
    timeout_s
        The same as for `connect`.

    Raises
    ------
    FileNotFound
        The program was not found.
    InvalidArgument
        An argument or a parameter of the experiment is not allowed. `violations` lists all of them.
    ProgramFailed
        The server did not start. The message contains the last lines of its output.

    Examples
    --------
    >>> import evod.aio
    >>> async with evod.aio.local(seed=42, experiment={"population_size": 50}) as lab:
    ...     world = await lab.world()
    ...     async for g in world.run(generations=2):
    ...         print(g)
    generation 1: best 337.6, mean 71.1, 25 of 50 alive
    generation 2: best 294.4, mean 84.7, 27 of 50 alive
    """
    server = await blocking_call(local_server.start, seed, experiment, data, speed, threads, program)
    try:
        lab = await connect(server.address, token="", ca="", timeout_s=timeout_s, client_name="evod.local")
        if data is not None:  # worlds that were already in the folder have their stored speed
            for world in await lab.worlds():
                await world.set_speed(speed)
    except BaseException:
        server.stop()
        raise
    return LocalLab(lab._link, server, speed)


class LocalLab(Lab):
    """A Lab with a private server, returned by `local`. Closing it stops the server."""

    def __init__(self, link: Link, server: local_server.Server, speed: float | str) -> None:
        super().__init__(link)
        self._server = server
        self._plans.speed_of_new_worlds = speed
        # Worlds and streams hold references to the link. When it is garbage collected, no object can use the server any
        # more.
        weakref.finalize(link, server.end)

    async def close(self) -> None:
        """Closes the connection and stops the server. Waits up to 30 s until the server has written its runs."""
        await super().close()
        await blocking_call(self._server.stop)

    @property
    def log(self) -> str:
        """The last 1,000 lines of the server's output."""
        return "\n".join(self._server.lines)

