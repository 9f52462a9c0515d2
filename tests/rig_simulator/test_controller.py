"""The controller simulator's states, watchdog and enable, at times that the test hands it."""

import unittest

import datagrams
from controller import Controller
from datagrams import ACTIVE, INACTIVE, STOPPED
from plant import Plant


class Site:
    """Sends commands to a controller and reads its answers."""

    def __init__(self, watchdog_s=0.0, rate_hz=None, stuck_after=None):
        self.said = []
        self.controller = Controller(self._make_plant, 1, watchdog_s, rate_hz, self.said.append, stuck_after)
        self.sequence = 0
        self.loop_count = 0

    @staticmethod
    def _make_plant(period_s):
        return Plant(1, {"type": "ideal"}, {"type": "elastic", "stiffness_n_per_m": 2.0e6}, period_s)

    def send(self, request, command_m=0.0, now_s=0.0, sequence=None, actuators=1):
        self.sequence += 1
        data = datagrams.encode_command(
            datagrams.Command(self.sequence if sequence is None else sequence, self.loop_count, request, 1_000_000, 0,
                              [command_m] * actuators))
        answer = self.controller.take(data, now_s)
        return None if answer is None else datagrams.decode_measurement(answer)

    def exchange(self, command_m, now_s=0.0):
        self.loop_count += 1
        return self.send(ACTIVE, command_m, now_s)


class States(unittest.TestCase):
    def setUp(self):
        self.site = Site()

    def test_it_follows_when_active_and_measures_what_it_does(self):
        self.assertEqual(self.site.send(INACTIVE).state, INACTIVE)
        self.assertEqual(self.site.send(ACTIVE).state, ACTIVE)
        answer = self.site.exchange(0.01)
        self.assertEqual(answer.displacement_m, [0.01])
        self.assertEqual(answer.force_n, [0.01 * 2.0e6])
        self.assertEqual(answer.command_sequence, self.site.sequence)
        self.assertEqual(answer.status, datagrams.FOLLOWS_DATAGRAMS)

    def test_a_stop_holds_until_an_inactive(self):
        self.site.send(INACTIVE)
        self.site.exchange(0.0)
        self.site.exchange(0.01)
        self.assertEqual(self.site.send(STOPPED).state, STOPPED)
        answer = self.site.exchange(0.05)
        self.assertEqual((answer.state, answer.displacement_m), (STOPPED, [0.01]))
        self.assertEqual(self.site.send(INACTIVE, sequence=1).state, INACTIVE)
        self.assertEqual(self.site.said, ["enable on", "enable off: requested by the site"])

    def test_nothing_moves_unasked(self):
        self.assertIsNone(self.site.exchange(0.01).displacement_m[0] or None)
        self.assertEqual(self.site.exchange(0.01).state, INACTIVE)

    def test_stuck_sensors_repeat_their_last_reading(self):
        self.site = Site(stuck_after=3)
        self.site.send(INACTIVE)
        self.site.send(ACTIVE)
        readings = [self.site.exchange(0.001 * i) for i in range(1, 6)]
        self.assertEqual([r.displacement_m[0] for r in readings], [0.001, 0.002, 0.002, 0.002, 0.002])
        self.assertEqual(readings[-1].force_n, [0.002 * 2.0e6])

    def test_an_older_command_is_not_taken(self):
        self.site.send(INACTIVE)
        self.site.exchange(0.0)
        self.site.exchange(0.01)
        self.assertIsNone(self.site.send(ACTIVE, 0.5, sequence=2))
        answer = self.site.exchange(0.02)
        self.assertEqual((answer.displacement_m, answer.discarded), ([0.02], 1))

    def test_another_number_of_actuators_is_not_taken(self):
        self.assertIsNone(self.site.send(INACTIVE, actuators=2))
        self.assertIn("2 actuators; this rig has 1", self.site.said[0])

    def test_sequence_numbers_wrap(self):
        self.site.sequence = 0xFFFFFFFD
        self.site.send(INACTIVE)
        self.site.exchange(0.0)
        self.assertIsNotNone(self.site.send(ACTIVE, sequence=0))


class Watchdog(unittest.TestCase):
    def test_silence_stops_it_and_drops_the_enable(self):
        site = Site(watchdog_s=0.05)
        site.send(INACTIVE)
        site.controller.advance(10.0)  # nothing to watch before it is active
        site.exchange(0.0, now_s=10.0)
        site.controller.advance(10.049)
        self.assertEqual(site.controller.state, ACTIVE)
        site.controller.advance(10.051)
        self.assertEqual(site.controller.state, STOPPED)
        self.assertEqual(site.said, ["enable on", "enable off: watchdog: the control loop of the site did not run for 0.05 s"])
        answer = site.exchange(0.01, now_s=10.06)
        self.assertEqual(answer.state, STOPPED)
        self.assertTrue(answer.status & datagrams.WATCHDOG_EXPIRED)

    def test_datagrams_of_a_loop_that_stands_still_are_silence(self):
        site = Site(watchdog_s=0.05)
        site.send(INACTIVE)
        site.exchange(0.0)
        for hundredth in range(1, 6):
            site.send(ACTIVE, 0.0, now_s=0.01 * hundredth)
        site.controller.advance(0.051)
        self.assertEqual(site.controller.state, STOPPED)

    def test_commands_keep_it_quiet(self):
        site = Site(watchdog_s=0.05)
        site.send(INACTIVE)
        for sample in range(100):
            site.exchange(0.0, now_s=0.04 * sample)
            site.controller.advance(0.04 * sample + 0.04)
        self.assertEqual(site.controller.state, ACTIVE)


class Pace(unittest.TestCase):
    def test_lost_commands_lie_straight_between_those_that_came(self):
        site = Site()
        steps = []
        site.send(INACTIVE)
        site.exchange(0.0)
        plant = site.controller._plant
        step, plant.step = plant.step, lambda command_m: (steps.append(command_m[0]), step(command_m))
        site.loop_count += 3
        site.exchange(0.04)
        self.assertEqual([round(m, 12) for m in steps], [0.01, 0.02, 0.03, 0.04])

    def test_with_a_clock_it_moves_on_between_the_commands(self):
        site = Site(rate_hz=100.0)
        site.send(INACTIVE)
        site.send(ACTIVE, 0.01, now_s=1.0)
        self.assertEqual(site.exchange(0.02, now_s=1.005).displacement_m, [0.0])
        site.controller.advance(1.011)
        self.assertEqual(site.exchange(0.03, now_s=1.012).displacement_m, [0.02])


if __name__ == "__main__":
    unittest.main()
