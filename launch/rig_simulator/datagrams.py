"""The two datagrams of docs/udp_rig.md, protocol version 1, written from that page alone."""

import struct
import zlib
from dataclasses import dataclass, field

VERSION = 1
ACTUATORS_MAX = 12

# Values of the request of a command and of the state of a controller.
INACTIVE, ACTIVE, STOPPED, FAULT = range(4)

# Bits of a measurement's status.
FOLLOWS_DATAGRAMS, WATCHDOG_EXPIRED, COMMAND_LIMITED, EMERGENCY_STOPPED = 1, 2, 4, 8

_COMMAND = struct.Struct("<4sHHIIBBHIq12d")
_MEASUREMENT = struct.Struct("<4sHHIIBBHIq12d12d")
_CHECKSUM = struct.Struct("<I")
COMMAND_BYTES = _COMMAND.size + _CHECKSUM.size
MEASUREMENT_BYTES = _MEASUREMENT.size + _CHECKSUM.size


class NotADatagram(Exception):
    """The bytes are not a datagram of this protocol; the text gives the reason."""


@dataclass
class Command:
    sequence: int = 0
    loop_count: int = 0
    request: int = INACTIVE
    control_period_ns: int = 0
    time_ns: int = 0
    displacement_m: list = field(default_factory=list)


@dataclass
class Measurement:
    sequence: int = 0
    command_sequence: int = 0
    state: int = INACTIVE
    status: int = 0
    discarded: int = 0
    time_ns: int = 0
    displacement_m: list = field(default_factory=list)
    force_n: list = field(default_factory=list)


def encode_command(command):
    count = len(command.displacement_m)
    return _sealed(_COMMAND.pack(b"HTDC", VERSION, COMMAND_BYTES, command.sequence, command.loop_count,
                                 command.request, count, 0, command.control_period_ns, command.time_ns,
                                 *_filled(command.displacement_m)))


def decode_command(data):
    (sequence, loop_count, request, count, _, period_ns, time_ns, *values) = _opened(data, b"HTDC", _COMMAND, STOPPED)
    return Command(sequence, loop_count, request, period_ns, time_ns, values[:count])


def encode_measurement(measurement):
    count = len(measurement.displacement_m)
    return _sealed(_MEASUREMENT.pack(b"HTDM", VERSION, MEASUREMENT_BYTES, measurement.sequence,
                                     measurement.command_sequence, measurement.state, count, measurement.status,
                                     measurement.discarded, measurement.time_ns,
                                     *_filled(measurement.displacement_m), *_filled(measurement.force_n)))


def decode_measurement(data):
    (sequence, command_sequence, state, count, status, discarded, time_ns,
     *values) = _opened(data, b"HTDM", _MEASUREMENT, FAULT)
    return Measurement(sequence, command_sequence, state, status, discarded, time_ns, values[:count],
                       values[ACTUATORS_MAX:ACTUATORS_MAX + count])


def _filled(values):
    return values + [0.0] * (ACTUATORS_MAX - len(values))


def _sealed(data):
    return data + _CHECKSUM.pack(zlib.crc32(data))


def _opened(data, magic, layout, highest_state):
    """Checks the common parts of both datagrams; returns the fields after the size."""
    if len(data) < 8 or data[:4] != magic:
        raise NotADatagram(f"it does not start with {magic.decode()}")
    version, size = struct.unpack_from("<HH", data, 4)
    if version != VERSION:
        raise NotADatagram(f"protocol version {version}; expected {VERSION}")
    if len(data) != size or size != layout.size + _CHECKSUM.size:
        raise NotADatagram(f"{len(data)} bytes; expected {layout.size + _CHECKSUM.size}")
    (checksum,) = _CHECKSUM.unpack_from(data, layout.size)
    if checksum != zlib.crc32(data[:layout.size]):
        raise NotADatagram("the checksum is wrong")
    fields = layout.unpack_from(data)[3:]
    if not 1 <= fields[3] <= ACTUATORS_MAX:
        raise NotADatagram(f"{fields[3]} actuators; expected 1 to {ACTUATORS_MAX}")
    if fields[2] > highest_state:
        raise NotADatagram(f"request or state {fields[2]}; expected 0 to {highest_state}")
    return fields
