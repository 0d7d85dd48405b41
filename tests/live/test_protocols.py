"""Packets that are sent, read by decoders that are not ours; and packets that others send."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pythonosc.osc_bundle import OscBundle
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.errors import FaceEditError
from faceedit_app.live import ifacialmocap, livelink, vmc
from faceedit_app.live.pose import BadPacket, Pose, second_of_day
from faceedit_app.live.protocols import (
    LOOPBACK,
    PROTOCOLS,
    Receiver,
    Sender,
    find_protocol,
    own_address,
)

WEIGHTS = np.linspace(0, 1, 52).astype(np.float32)
POSE = Pose(WEIGHTS, 3723.5125, 60.0, "FaceEdit")


def test_the_clock_of_what_is_sent_goes_on_as_a_second_ends() -> None:
    at = [second_of_day(1_700_000_000.0 + part) for part in (0.0, 0.5, 0.9995, 1.0, 1.25)]
    assert np.diff(at) == pytest.approx([0.5, 0.4995, 0.0005, 0.25], abs=1e-6)
    assert at[0] % 60 == 1_700_000_000 % 60  # time zones differ by whole minutes
    assert 0 <= second_of_day() < 24 * 3600 + 1  # a leap second


# --- Live Link Face ------------------------------------------------------------------------------


def test_a_live_link_packet_has_the_layout_of_the_application() -> None:
    packet = livelink.encode(POSE)
    assert packet[0] == 6
    assert packet[1:5] == struct.pack(">i", 36)
    place = 5 + 36
    (length,) = struct.unpack_from(">i", packet, place)
    assert packet[place + 4 : place + 4 + length] == b"FaceEdit"
    place += 4 + length
    frame, part, rate, denominator = struct.unpack_from(">ifii", packet, place)
    assert (frame, rate, denominator) == (223410, 60, 1)
    assert part == pytest.approx(0.75, abs=1e-3)
    assert packet[place + 16] == 61
    values = struct.unpack_from(">61f", packet, place + 17)
    assert len(packet) == place + 17 + 4 * 61
    np.testing.assert_array_equal(np.array(values[:52], np.float32), WEIGHTS)
    assert values[52:] == (0.0,) * 9


@given(st.floats(0, 86400), st.sampled_from([24.0, 25.0, 29.97, 30.0, 59.94, 60.0]))
def test_a_live_link_packet_is_read_as_it_was_sent(seconds: float, rate: float) -> None:
    turned = Pose(WEIGHTS, seconds, rate, "Ä", np.linspace(-1, 1, 9).astype(np.float32))
    back = livelink.decode(livelink.encode(turned))
    np.testing.assert_array_equal(back.weights, WEIGHTS)
    assert back.rotations is not None
    assert turned.rotations is not None
    np.testing.assert_array_equal(back.rotations, turned.rotations)
    assert back.seconds == pytest.approx(seconds, abs=1e-4)
    assert back.subject == "Ä"
    assert back.rate == pytest.approx(rate)


def test_a_packet_without_a_face_is_none() -> None:
    packet = livelink.encode(POSE)
    lost = packet[: -(61 * 4 + 1)] + b"\0"
    with pytest.raises(BadPacket, match="no face"):
        livelink.decode(lost)


# --- VMC -----------------------------------------------------------------------------------------


def test_python_osc_reads_a_vmc_bundle() -> None:
    packet = vmc.encode(POSE)
    assert OscBundle.dgram_is_bundle(packet)
    messages = [m for m in OscBundle(packet) if isinstance(m, OscMessage)]
    blends = [m.params for m in messages if m.address == "/VMC/Ext/Blend/Val"]
    assert [name for name, _ in blends] == list(ARKIT_CHANNELS)
    np.testing.assert_array_equal(np.array([v for _, v in blends], np.float32), WEIGHTS)
    assert messages[-1].address == "/VMC/Ext/Blend/Apply"
    assert messages[-1].params == []
    assert [m.params for m in messages if m.address == "/VMC/Ext/OK"] == [[1]]


def built(address: str, *values: object) -> OscMessage:
    builder = OscMessageBuilder(address)
    for value in values:
        builder.add_arg(value)  # type: ignore[arg-type]
    return builder.build()


def test_what_python_osc_builds_is_read() -> None:
    """Names in other spellings, messages one by one, and kinds that are not needed."""
    decode = vmc.Decoder()
    single = [
        built("/VMC/Ext/Blend/Val", "JawOpen", 0.25),
        built("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        built("/VMC/Ext/Blend/Val", "eyeBlink_L", 0.5),
        built("/VMC/Ext/Blend/Val", "Joy", 0.9),
        built("/VMC/Ext/Unknown", b"blob", True),
    ]
    assert [decode(message.dgram) for message in single] == [None] * 5
    bundle = OscBundleBuilder(IMMEDIATELY)
    bundle.add_content(built("/VMC/Ext/T", 12.5))
    bundle.add_content(built("/VMC/Ext/Blend/Apply"))
    pose = decode(bundle.build().dgram)
    assert pose is not None
    assert pose.seconds == 12.5
    expected = np.zeros(52, np.float32)
    expected[ARKIT_INDEX["jawOpen"]], expected[ARKIT_INDEX["eyeBlinkLeft"]] = 0.25, 0.5
    np.testing.assert_array_equal(pose.weights, expected)
    assert decode(built("/VMC/Ext/Blend/Apply").dgram) is None


@pytest.mark.parametrize(
    ("angles", "looks_at"),
    [
        ((0.5, 0.0, 0.0), (0.479, 0.0, 0.878)),  # to the person's right, which is Unity's +X
        ((0.0, 0.3, 0.0), (0.0, -0.296, 0.955)),  # down
        ((0.0, 0.0, 0.4), (0.0, 0.0, 1.0)),
    ],
)
def test_heads_and_eyes_are_bones_in_the_axes_of_unity(
    angles: tuple[float, ...], looks_at: tuple[float, ...]
) -> None:
    rotations = np.array([*angles, 0, 0.1, 0, 0, -0.1, 0], np.float32)
    packet = vmc.encode(Pose(WEIGHTS, 1.0, rotations=rotations))
    bones = {
        m.params[0]: np.array(m.params[4:])
        for m in OscBundle(packet)
        if isinstance(m, OscMessage) and m.address == "/VMC/Ext/Bone/Pos"
    }
    assert list(bones) == ["Head", "LeftEye", "RightEye"]
    x, y, z, w = bones["Head"]
    ahead = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    np.testing.assert_allclose(ahead, looks_at, atol=0.001)
    if angles[2]:  # tilted to the person's right: the top goes there
        assert 2 * (x * y - w * z) > 0.3
    pose = vmc.Decoder()(packet)
    assert pose is not None
    assert pose.rotations is not None
    np.testing.assert_allclose(pose.rotations, rotations, atol=1e-5)


@pytest.mark.parametrize("quaternion", [(0.0,) * 4, (float("nan"),) * 4, (1, 2, 3, 4)])
def test_a_bone_that_is_not_turned_is_refused(quaternion: tuple[float, ...]) -> None:
    with pytest.raises(BadPacket):
        vmc.Decoder()(built("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, *quaternion).dgram)


# --- iFacialMocap --------------------------------------------------------------------------------


@pytest.mark.parametrize("mark", ["-", "&"])
def test_a_text_of_ifacialmocap(mark: str) -> None:
    text = (
        f"mouthSmile_R{mark}45|jawOpen{mark}7|trackingStatus{mark}1|=head#10,-20.5,30,0.1,0,-0.2|"
    )
    pose = ifacialmocap.decode((text + "rightEye#1,2,3|leftEye#4,5,6|").encode())
    assert pose.weights[ARKIT_INDEX["mouthSmileRight"]] == np.float32(0.45)
    assert pose.weights[ARKIT_INDEX["jawOpen"]] == np.float32(0.07)
    assert np.count_nonzero(pose.weights) == 2
    assert pose.rotations is not None
    np.testing.assert_allclose(np.degrees(pose.rotations[:3]), [-20.5, 10, 30], rtol=1e-5)
    np.testing.assert_allclose(np.degrees(pose.rotations[3:]), [5, 4, 6, 2, 1, 3], rtol=1e-5)


# --- what comes from anywhere --------------------------------------------------------------------

GOOD = {
    "livelink": livelink.encode(POSE),
    "vmc": vmc.encode(POSE),
    "ifacialmocap": b"jawOpen-7|=head#1,2,3,4,5,6|",
}


@given(data=st.data(), key=st.sampled_from(sorted(GOOD)))
def test_damaged_packets_are_refused_or_harmless(data: st.DataObject, key: str) -> None:
    decode = find_protocol(key).decoder()
    packet = bytearray(GOOD[key])
    for _ in range(data.draw(st.integers(0, 4))):
        packet[data.draw(st.integers(0, len(packet) - 1))] = data.draw(st.integers(0, 255))
    cut = bytes(packet[: data.draw(st.integers(0, len(packet)))])
    for content in (bytes(packet), cut, data.draw(st.binary(max_size=200))):
        try:
            pose = decode(content)
        except BadPacket:
            continue
        if pose is not None:
            assert pose.weights.shape == (52,)
            assert np.isfinite(pose.weights).all()


@pytest.mark.parametrize("protocol", [p for p in PROTOCOLS if p.encode], ids=lambda p: p.key)
def test_what_is_sent_is_received(protocol: object) -> None:
    assert isinstance(protocol, type(PROTOCOLS[0]))
    receiver = Receiver(protocol, LOOPBACK, 0)
    sender = Sender(protocol, *receiver.address)
    try:
        assert sender.send(POSE)
        pose = receiver.receive()
        assert pose is not None
        np.testing.assert_array_equal(pose.weights, WEIGHTS)
        sender._socket.sendto(b"nonsense", receiver.address)
        assert receiver.receive() is None
        assert receiver.ignored == 1
    finally:
        sender.close()
        receiver.close()


def test_what_cannot_be_is_one_line() -> None:
    receiver = Receiver(PROTOCOLS[0], LOOPBACK, 0)
    try:
        for wrong in (
            lambda: Receiver(PROTOCOLS[0], *receiver.address),
            lambda: Receiver(PROTOCOLS[0], "198.51.100.1", 0),
            lambda: Sender(PROTOCOLS[0], LOOPBACK, 0),
            lambda: Sender(PROTOCOLS[0], LOOPBACK, 70000),
            lambda: Sender(PROTOCOLS[0], "no such host", 1),
            lambda: find_protocol("ifacialmocap", sends=True),
            lambda: find_protocol("bvh"),
        ):
            with pytest.raises(FaceEditError) as error:
                wrong()
            assert len(str(error.value).splitlines()) == 1
    finally:
        receiver.close()
    assert own_address().count(".") == 3
