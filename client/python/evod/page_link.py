"""Links to the page of a server, at which a browser shows a moment of a world. client/core/page_link.h defines the same
form."""
from __future__ import annotations

import re
import warnings

from evod.endpoint import Endpoint
from evod.errors import DamagedData, FailedPrecondition, InvalidArgument
from evod.v1 import session_pb2, world_pb2


def page_of(welcome: session_pb2.Welcome, server: Endpoint, tls: bool) -> str:
    """Returns the page of the server, such as "http://lab:7745/".

    server, tls  how this client is connected.

    >>> page_of(session_pb2.Welcome(page_port=7745), Endpoint("lab"), tls=False)
    'http://lab:7745/'
    """
    if welcome.page_port == 0:
        why = "start it with --web and, for other machines, --http-bind; or give the address of the page"
        raise FailedPrecondition(f"the server at {server} has no page that this machine can reach: {why}")
    host = welcome.page_host or server.host
    if not re.fullmatch(r"[0-9A-Za-z._:%-]+", host):
        raise DamagedData("the server reports a host of its page that a URL cannot contain")
    return f"{'https' if tls else 'http'}://{Endpoint(host, welcome.page_port)}/"


def warn_of_other_host(welcome: session_pb2.Welcome, server: Endpoint) -> None:
    """Warns if the page is at another host than the server to which this client is connected."""
    same = welcome.page_host == server.host or all(map(_is_this_machine, (welcome.page_host, server.host)))
    if welcome.page_host and not same:
        warnings.warn(f"the server reports that its page is at another host: {welcome.page_host}", stacklevel=4)


def _is_this_machine(host: str) -> bool:
    return host in ("localhost", "::1") or re.fullmatch(r"127[.][0-9.]+", host) is not None


def link_of(
    page: str, info: world_pb2.WorldInfo, generation: int | None, tick: int | None, island: int | None,
    organism: int | None, live: bool,
) -> str:
    """Returns the link to a moment of a world; by default to the moment of `info`.

    >>> link_of("http://lab:7745", world_pb2.WorldInfo(name="a", generation=3), None, None, 1, 7, live=False)
    'http://lab:7745/#world=a&generation=3&tick=0&island=1&organism=7'
    """
    if not re.fullmatch(r"https?://[!$-;=?-Z_a-z~\[\]%]+", page):
        raise InvalidArgument(f"page: got '{page}', allowed a URL without #, such as https://evod.example.org/")
    world = info.replay.replay_of or info.name
    if not re.fullmatch(r"[!$-;=?-Z_a-z~\[\]%]+", world):
        raise DamagedData("the server reports a name of the world that a URL cannot contain")
    if live and generation is not None:
        raise InvalidArgument("generation and live are both given: use one of them")
    if tick is not None and generation is None:
        raise InvalidArgument("tick is given without generation: give both")
    if generation is None:
        generation, tick = info.generation, info.generation_tick
    elif not 1 <= generation <= info.generation:
        raise InvalidArgument(f"generation: got {generation}, allowed 1 to {info.generation}")
    fields = [("world", world)]
    if not live:
        fields += [("generation", str(generation)), ("tick", str(tick or 0))]
    if island is not None or organism is not None:
        fields.append(("island", str(island or 0)))
    if organism is not None:
        fields.append(("organism", str(organism)))
    return page + ("" if page.endswith("/") else "/") + "#" + "&".join("=".join(field) for field in fields)
