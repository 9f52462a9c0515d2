"""The simulator's plant against numerical integration that knows nothing of its closed solution."""

import math
import unittest

from plant import Bilinear, Delay, Plant, SecondOrder


def integrated(command, natural_frequency_hz, damping_ratio, period_s, steps, substeps=200):
    """Classical Runge-Kutta; its error with these substeps is below 1e-12 of the command."""
    omega = 2.0 * math.pi * natural_frequency_hz
    h = period_s / substeps

    def rate(t, x, v):
        return v, omega * omega * (command(t) - x) - 2.0 * damping_ratio * omega * v

    x = v = 0.0
    path = []
    for step in range(steps):
        # At rest one period before the first step.
        for substep in range(substeps):
            t = (step - 1) * period_s + substep * h
            a = rate(t, x, v)
            b = rate(t + h / 2, x + h / 2 * a[0], v + h / 2 * a[1])
            c = rate(t + h / 2, x + h / 2 * b[0], v + h / 2 * b[1])
            d = rate(t + h, x + h * c[0], v + h * c[1])
            x += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            v += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        path.append(x)
    return path


class TransferSystems(unittest.TestCase):
    PERIOD_S = 0.001

    def straight(self, samples, delay_s):
        def command(t):
            place = (t - delay_s) / self.PERIOD_S
            index = math.floor(place)
            at = lambda i: samples[i] if 0 <= i < len(samples) else 0.0
            return at(index) + (place - index) * (at(index + 1) - at(index))

        return command

    def test_second_order_is_exact_for_straight_commands(self):
        samples = [0.0] + [0.01 * math.sin(0.3 * i) + 0.002 * (i % 3) for i in range(60)]
        for damping_ratio in (0.05, 0.9, 1.0, 2.5):
            # Whole periods of delay, so that the numerical integration meets the corners at its step ends.
            for delay_s in (0.0, 0.004):
                with self.subTest(damping_ratio=damping_ratio, delay_s=delay_s):
                    axis = SecondOrder(15.0, damping_ratio, delay_s, self.PERIOD_S)
                    expected = integrated(self.straight(samples, delay_s), 15.0, damping_ratio, self.PERIOD_S,
                                          len(samples))
                    for sample, x in zip(samples, expected):
                        self.assertAlmostEqual(axis.step(sample), x, delta=1e-11)

    def test_a_delay_of_a_broken_number_of_periods_follows_a_cubic(self):
        def cubic(t):
            return 1.0 + t * (2.0 + t * (-3.0 + 0.5 * t))

        axis = Delay(0.00225, self.PERIOD_S)
        for i in range(10):
            measured = axis.step(cubic(i))
            if i > 3:
                self.assertAlmostEqual(measured, cubic(i - 2.25), delta=1e-12)

    def test_a_delay_within_a_period_follows_a_parabola(self):
        axis = Delay(0.00025, self.PERIOD_S)
        for i in range(10):
            measured = axis.step(1.0 + 2.0 * i - 3.0 * i * i)
            if i > 1:
                self.assertAlmostEqual(measured, 1.0 + 2.0 * (i - 0.25) - 3.0 * (i - 0.25) ** 2, delta=1e-12)

    def test_a_delay_of_whole_periods_is_exact(self):
        axis = Delay(0.002, self.PERIOD_S)
        self.assertEqual([axis.step(m) for m in (1.0, 2.0, 4.0, 8.0)], [0.0, 0.0, 1.0, 2.0])


class Laws(unittest.TestCase):
    def test_bilinear_yields_and_unloads_with_its_first_stiffness(self):
        law = Bilinear(stiffness_n_per_m=100.0, yield_force_n=1.0, hardening_ratio=0.1)
        self.assertAlmostEqual(law.force_n(0.005), 0.5)
        self.assertAlmostEqual(law.force_n(0.02), 1.0 + 10.0 * 0.01)
        self.assertAlmostEqual(law.force_n(0.01), 1.1 - 100.0 * 0.01)

    def test_a_section_that_is_wrong_says_where(self):
        with self.assertRaisesRegex(ValueError, "specimen: type 'elastc'; expected one of elastic, bilinear"):
            Plant(1, {"type": "ideal"}, {"type": "elastc"}, 0.001)
        with self.assertRaisesRegex(ValueError, "specimen: stiffness_n_per_m is missing"):
            Plant(1, {"type": "ideal"}, {"type": "elastic"}, 0.001)
        with self.assertRaisesRegex(ValueError, "transfer system: unknown keys delay"):
            Plant(1, {"type": "ideal", "delay": 1}, {"type": "elastic", "stiffness_n_per_m": 1.0}, 0.001)


if __name__ == "__main__":
    unittest.main()
