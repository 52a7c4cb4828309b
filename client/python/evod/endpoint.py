"""The address of a server, and the token and TLS settings for connecting to it."""
from __future__ import annotations

import dataclasses
import os
import ssl

from evod import input_file
from evod.errors import Error, FileNotFound, InvalidArgument

DEFAULT_PORT = 7744


@dataclasses.dataclass(frozen=True)
class Endpoint:
    """The address of a server."""

    host: str = "localhost"  #: without brackets
    port: int = DEFAULT_PORT

    @classmethod
    def parse(cls, text: str) -> Endpoint:
        """Parses HOST, HOST:PORT, [IPV6] or [IPV6]:PORT. An IPv6 address without a port needs no brackets.

        >>> Endpoint.parse("lab.example:7000")
        Endpoint(host='lab.example', port=7000)
        >>> Endpoint.parse("::1")
        Endpoint(host='::1', port=7744)
        >>> Endpoint.parse("[::1")
        Traceback (most recent call last):
        evod.errors.InvalidArgument: server: got '[::1', allowed HOST, HOST:PORT or [IPV6]:PORT: ']' is missing
        """
        host, port = text, None
        if text.startswith("["):
            host, bracket, rest = text[1:].partition("]")
            if not bracket:
                raise _malformed(text, "']' is missing")
            if rest and not rest.startswith(":"):
                raise _malformed(text, "']' must be followed by ':' and a port")
            port = rest[1:] if rest else None
        elif text.count(":") == 1:
            host, port = text.split(":")
        if not host:
            raise _malformed(text, "the host is missing")
        if port is None:
            return cls(host)
        if not (port.isascii() and port.isdigit() and len(port) <= 5 and 1 <= int(port) <= 65535):
            raise _malformed(text, "the port is not a number from 1 to 65535")
        return cls(host, int(port))

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def _malformed(text: str, why: str) -> InvalidArgument:
    return InvalidArgument(f"server: got '{text}', allowed HOST, HOST:PORT or [IPV6]:PORT: {why}")


def _unusable(error: Exception, message: str) -> Error:
    """Returns the error for a file that cannot be used."""
    return (FileNotFound if isinstance(error, FileNotFoundError) else InvalidArgument)(message)


def read_token(token: str | None, token_file: str | os.PathLike[str] | None) -> str:
    """Returns `token`; by default the first word of the file; without a file the value of EVOD_TOKEN, or "" if it is
    unset.

    Raises InvalidArgument if users other than the owner can read the file.
    """
    if token is not None:
        if token_file is not None:
            raise InvalidArgument("token and token_file are both given: use one of them")
        return token
    if token_file is None:
        return os.environ.get("EVOD_TOKEN", "")
    try:
        data, about = input_file.read_input(token_file, "a token file", input_file.TOKEN_BYTES_MAX)
        if about.st_mode & 0o077:
            why = "other users can read the file: run chmod 600 on it"
            raise InvalidArgument(f"token_file: {os.fspath(token_file)}: {why}")
        words = data.decode("utf-8-sig").split()
    except (OSError, UnicodeDecodeError) as error:
        why = str(error.strerror) if isinstance(error, OSError) else "the file is not text"
        raise _unusable(error, f"token_file: {os.fspath(token_file)}: {why}") from None
    if not words:
        raise InvalidArgument(f"token_file: {os.fspath(token_file)}: the file contains no token")
    return words[0]


def tls_context(
    tls: bool, ca: str | os.PathLike[str] | None, cert: str | os.PathLike[str] | None,
                key: str | os.PathLike[str] | None
) -> ssl.SSLContext | None:
    """Returns the TLS settings; None if TLS is not used. Each of `tls`, `ca` and `cert` turns TLS on.

    ca         PEM file with trusted certificates. Without it, the file in the variable EVOD_CA is used, or
               else the certificates that the system trusts.
    cert, key  PEM files with the client certificate and its private key. One file may contain both.
    """
    if key is not None and cert is None:
        raise InvalidArgument("key requires cert: give the PEM file of the certificate, too")
    ca = (os.environ.get("EVOD_CA") if ca is None else ca) or None
    if not tls and ca is None and cert is None:
        return None
    try:
        if ca is not None:
            input_file.read_input(ca, "a PEM file", input_file.PEM_BYTES_MAX)
        context = ssl.create_default_context(cafile=ca)
    except (OSError, ssl.SSLError) as error:
        raise _unusable(error, f"{ca} cannot be used for TLS: {error.strerror or error}") from None
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    if cert is not None:
        try:
            for file in (cert,) if key is None else (cert, key):
                input_file.read_input(file, "a PEM file", input_file.PEM_BYTES_MAX)
            context.load_cert_chain(cert, key)
        except (OSError, ssl.SSLError) as error:
            raise _unusable(error, f"{cert} cannot be used for TLS: {error.strerror or error}") from None
    return context
