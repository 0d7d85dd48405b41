"""The table of protocols, and sending and receiving with them."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from faceedit_app.core.errors import FaceEditError
from faceedit_app.live import ifacialmocap, livelink, vmc
from faceedit_app.live.pose import BadPacket, Pose

LOOPBACK, EVERYWHERE = "127.0.0.1", "0.0.0.0"
_LARGEST = 65_535  # bytes of a datagram
_PATIENCE = 0.2  # seconds after which a receiver looks whether it should stop


@dataclass(frozen=True)
class Protocol:
    """A protocol.

    Attributes:
        key: the name on the command line.
        name: shown to the user.
        port: that its receivers listen on.
        hints: what to do at the other end, to receive from FaceEdit and to send to it.
        encode: makes the datagram of a pose; None if FaceEdit cannot send it.
        decoder: makes a function from datagrams to poses.
        greeting: what makes the sender send.
    """

    key: str
    name: str
    port: int
    hints: tuple[str, str]
    encode: Callable[[Pose], bytes] | None
    decoder: Callable[[], Callable[[bytes], Pose | None]]
    greeting: bytes = b""


PROTOCOLS: tuple[Protocol, ...] = (
    Protocol(
        "livelink",
        "Live Link Face",
        11111,
        (
            "In Unreal, switch on Apple ARKit Face Support and choose the subject FaceEdit under "
            "Live Link",
            "In the application, Settings > Live Link > Add Target: this computer's address and "
            "port; then switch on LIVE",
        ),
        livelink.encode,
        lambda: livelink.decode,
    ),
    Protocol(
        "vmc",
        "VMC",
        39539,
        (
            "In VSeeFace, Warudo or EVMC4U (Unity), switch on the VMC receiver on this port",
            "In the sender, give this computer's address and port as the VMC receiver",
        ),
        vmc.encode,
        vmc.Decoder,
    ),
    Protocol(
        "ifacialmocap",
        "iFacialMocap",
        49983,
        ("", "Give the phone's address, which the application shows"),
        None,
        lambda: ifacialmocap.decode,
        ifacialmocap.GREETING,
    ),
)


def find_protocol(key: str, sends: bool = False) -> Protocol:
    """The protocol of a key.

    Args:
        sends: only those that FaceEdit can send.

    Raises:
        FaceEditError: there is none.
    """
    known = [one for one in PROTOCOLS if one.encode is not None or not sends]
    for protocol in known:
        if protocol.key == key:
            return protocol
    raise FaceEditError(f"{key}: the protocol must be {' or '.join(one.key for one in known)}")


class Sender:
    """Sends poses to one address.

    Raises:
        FaceEditError: the address is unknown.
    """

    def __init__(self, protocol: Protocol, host: str, port: int) -> None:
        assert protocol.encode is not None
        self._encode, self.protocol = protocol.encode, protocol
        self.address = _found(host, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)

    def send(self, pose: Pose) -> bool:
        """Send a pose; False if the network did not take it, which a later one may mend."""
        try:
            self._socket.sendto(self._encode(pose), self.address)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Free the socket."""
        self._socket.close()


class Receiver:
    """Receives poses on a port.

    Attributes:
        address: host and port on which it listens.
        ignored: how many datagrams were none of the protocol's.

    Raises:
        FaceEditError: the port is taken, or the address is not one of this computer.
    """

    def __init__(
        self, protocol: Protocol, host: str = EVERYWHERE, port: int | None = None, phone: str = ""
    ) -> None:
        """Listen, and greet the phone at an address, if the protocol needs it."""
        self._decode, self.ignored = protocol.decoder(), 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(_PATIENCE)
        wanted = protocol.port if port is None else port
        try:
            self._socket.bind((host, wanted))
        except (OSError, OverflowError) as error:
            self._socket.close()
            reason = (getattr(error, "strerror", "") or str(error)).lower()
            raise FaceEditError(
                f"{host}:{wanted}: FaceEdit cannot listen there ({reason}); "
                "close what uses that port, or choose another"
            ) from error
        self.address: tuple[str, int] = self._socket.getsockname()
        self._greeted = _found(phone, protocol.port) if phone and protocol.greeting else None
        self._greeting = protocol.greeting
        self.greet()

    def greet(self) -> None:
        """Ask the phone to send, if the protocol needs that."""
        if self._greeted is not None:
            with suppress(OSError):
                self._socket.sendto(self._greeting, self._greeted)

    def receive(self) -> Pose | None:
        """The next pose; None if none came within a fifth of a second."""
        try:
            packet = self._socket.recv(_LARGEST)
        except OSError:  # nothing came, or it is closed
            return None
        try:
            return self._decode(packet)
        except BadPacket:
            self.ignored += 1
            return None

    def close(self) -> None:
        """Free the port."""
        self._socket.close()


def own_address() -> str:
    """This computer's address in its network, for the phone; the loopback address if none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe, suppress(OSError):
        probe.connect(("192.0.2.1", 9))  # sends nothing; an address for documentation
        return str(probe.getsockname()[0])
    return LOOPBACK


def _found(host: str, port: int) -> tuple[str, int]:
    try:
        if not 0 < port < 65536:
            raise OSError("a port is from 1 to 65535")
        found = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)
        name, number = found[0][4][:2]
    except (OSError, UnicodeError) as error:
        reason = (getattr(error, "strerror", "") or str(error)).lower()
        raise FaceEditError(f"{host}:{port}: is not an address ({reason}); correct it") from error
    return str(name), int(number)
