"""The plant of the scenario's `type: simulated`: a transfer system and a law for each actuator, one step per
control period. The sections have the keys of docs/scenario.md. Commands are linear between steps, and a transfer system
that moves is integrated exactly for such commands; a mere delay takes them as smooth, by the same cubic as the site. So
the two programs have no discretisation error."""

import cmath
import math


class DelayLine:
    """The delayed command: linear between its samples, zero before the first."""

    def __init__(self, delay_s, period_s):
        # In whole nanoseconds, as the site counts time, so that 4 periods of 1 ms are exactly 4 ms.
        delay_ns, period_ns = round(delay_s * 1e9), round(period_s * 1e9)
        self._whole = delay_ns // period_ns
        self.fraction = (delay_ns % period_ns) / period_ns
        self._samples = [0.0] * (self._whole + 3)  # newest first

    def push(self, value):
        self._samples.insert(0, value)
        self._samples.pop()

    def value(self):
        return (1.0 - self.fraction) * self._samples[self._whole] + self.fraction * self.corner()

    def smooth_value(self):
        """By the cubic through two samples on either side; within the first period, the parabola through older ones."""
        f, at = self.fraction, self._whole
        a, b, older = self._samples[at : at + 3]
        if at == 0:
            return 0.5 * (1.0 - f) * (2.0 - f) * a + f * (2.0 - f) * b - 0.5 * f * (1.0 - f) * older
        newer = self._samples[at - 1]
        inside = 0.5 * (1.0 - f) * (2.0 - f) * a + 0.5 * f * (2.0 - f) * b
        return (1.0 + f) * inside - f * (1.0 - f) / 6.0 * ((2.0 - f) * newer + (1.0 + f) * older)

    def corner(self):
        """The corner of the command between the last two results of value()."""
        return self._samples[self._whole + 1]


class Delay:
    def __init__(self, delay_s, period_s):
        self._line = DelayLine(delay_s, period_s)

    def step(self, command_m):
        self._line.push(command_m)
        return self._line.smooth_value()


class SecondOrder:
    """x'' + 2 zeta omega x' + omega^2 x = omega^2 u(t - delay), by its closed solution for u = a + b t:
    the particular solution a + b t - 2 zeta b / omega, plus e^(A t) times the deviation of the state from it."""

    def __init__(self, natural_frequency_hz, damping_ratio, delay_s, period_s):
        self._omega = 2.0 * math.pi * natural_frequency_hz
        self._zeta = damping_ratio
        self._line = DelayLine(delay_s, period_s)
        self._period_s = period_s
        self._x = 0.0
        self._v = 0.0

    def step(self, command_m):
        begin = self._line.value()
        self._line.push(command_m)
        fraction = self._line.fraction
        if fraction > 0.0:
            self._move(begin, self._line.corner(), fraction * self._period_s)
        self._move(self._line.corner(), self._line.value(), (1.0 - fraction) * self._period_s)
        return self._x

    def _move(self, begin, end, t):
        omega, zeta = self._omega, self._zeta
        slope = (end - begin) / t
        lag = 2.0 * zeta * slope / omega
        x, v = self._x - (begin - lag), self._v - slope
        # e^(A t) = e^(-zeta omega t) (c I + s (A + zeta omega I)); s tends to t at critical damping.
        damped = omega * cmath.sqrt(1.0 - zeta * zeta)
        c = cmath.cos(damped * t).real
        s = (cmath.sin(damped * t) / damped).real if abs(damped) * t > 1e-8 else t
        decay = math.exp(-zeta * omega * t)
        self._x = decay * (c * x + s * (zeta * omega * x + v)) + end - lag
        self._v = decay * (c * v - s * (omega * omega * x + zeta * omega * v)) + slope


class Elastic:
    def __init__(self, stiffness_n_per_m):
        self._stiffness = stiffness_n_per_m

    def force_n(self, displacement_m):
        return self._stiffness * displacement_m


class Bilinear:
    """An elastic spring in parallel with an elastic, ideally plastic spring."""

    def __init__(self, stiffness_n_per_m, yield_force_n, hardening_ratio):
        self._beside = hardening_ratio * stiffness_n_per_m
        self._yielding = (1.0 - hardening_ratio) * stiffness_n_per_m
        self._yield_m = yield_force_n / stiffness_n_per_m
        self._slipped_m = 0.0

    def force_n(self, displacement_m):
        elastic_m = min(max(displacement_m - self._slipped_m, -self._yield_m), self._yield_m)
        self._slipped_m = displacement_m - elastic_m
        return self._beside * displacement_m + self._yielding * elastic_m


_TRANSFER_SYSTEMS = {
    "ideal": (lambda period_s: Delay(0.0, period_s), {}),
    "delay": (Delay, {"delay_s": None}),
    "second_order": (SecondOrder, {"natural_frequency_hz": None, "damping_ratio": None, "delay_s": 0.0}),
}
_LAWS = {
    "elastic": (Elastic, {"stiffness_n_per_m": None}),
    "bilinear": (Bilinear, {"stiffness_n_per_m": None, "yield_force_n": None, "hardening_ratio": None}),
}


def _read(section, table, what):
    """Returns the class for the type of the section, and its keys with defaults filled in."""
    values = dict(section)
    kind = values.pop("type", None)
    if kind not in table:
        raise ValueError(f"{what}: type {kind!r}; expected one of {', '.join(table)}")
    make, keys = table[kind]
    if set(values) - set(keys):
        raise ValueError(f"{what}: unknown keys {', '.join(sorted(set(values) - set(keys)))}")
    values = {key: values.get(key, default) for key, default in keys.items()}
    missing = [key for key, value in values.items() if value is None]
    if missing:
        raise ValueError(f"{what}: {', '.join(missing)} is missing")
    return make, values


class Plant:
    """Equal actuators, each with its own specimen. A new plant is made for each new control period."""

    def __init__(self, actuators, transfer_system, specimen, period_s):
        make_transfer_system, settings = _read(transfer_system, _TRANSFER_SYSTEMS, "transfer system")
        make_law, law = _read(specimen, _LAWS, "specimen")
        self._axes = [(make_transfer_system(**settings, period_s=period_s), make_law(**law)) for _ in range(actuators)]
        self.displacement_m = [0.0] * actuators
        self.force_n = [0.0] * actuators

    def step(self, command_m):
        self.displacement_m = [axis.step(command) for (axis, _), command in zip(self._axes, command_m)]
        self.force_n = [law.force_n(x) for (_, law), x in zip(self._axes, self.displacement_m)]
