"""The kept datagrams, read and written by the second implementation of docs/udp_rig.md."""

import math
import pathlib
import unittest

import datagrams
from datagrams import Command, Measurement, NotADatagram

KEPT = pathlib.Path(__file__).parents[1] / "contract" / "udp_datagrams"

# As in tests/unit/experimental_site/udp_datagram_test.cpp.
COMMAND = Command(sequence=0xFEDCBA98, loop_count=70000, request=datagrams.ACTIVE, control_period_ns=976562,
                  time_ns=12345678901234, displacement_m=[0.0125, -1.0 / 3.0, 2.5e-7])
MEASUREMENT = Measurement(sequence=4000000001, command_sequence=0xFEDCBA97, state=datagrams.ACTIVE,
                          status=datagrams.FOLLOWS_DATAGRAMS | datagrams.COMMAND_LIMITED, discarded=258,
                          time_ns=-5000000007, displacement_m=[0.012, -0.25, math.inf],
                          force_n=[-40.0e3, 0.1, 6.5e4])


class KeptDatagrams(unittest.TestCase):
    def test_the_command_is_read_and_written_byte_by_byte(self):
        data = (KEPT / "command_v1.bin").read_bytes()
        self.assertEqual(datagrams.decode_command(data), COMMAND)
        self.assertEqual(datagrams.encode_command(COMMAND), data)

    def test_the_measurement_is_read_and_written_byte_by_byte(self):
        data = (KEPT / "measurement_v1.bin").read_bytes()
        self.assertEqual(datagrams.decode_measurement(data), MEASUREMENT)
        self.assertEqual(datagrams.encode_measurement(MEASUREMENT), data)

    def test_every_single_damaged_byte_is_noticed(self):
        data = (KEPT / "command_v1.bin").read_bytes()
        for place in range(len(data)):
            damaged = bytearray(data)
            damaged[place] ^= 0x10
            with self.assertRaises(NotADatagram):
                datagrams.decode_command(bytes(damaged))

    def test_every_cut_is_noticed(self):
        data = (KEPT / "measurement_v1.bin").read_bytes()
        for size in range(len(data)):
            with self.assertRaises(NotADatagram):
                datagrams.decode_measurement(data[:size])


if __name__ == "__main__":
    unittest.main()
