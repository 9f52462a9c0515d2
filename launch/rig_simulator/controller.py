"""A controller that implements docs/udp_rig.md: states, watchdog, enable line. It receives the time as an
argument and owns no socket."""

import datagrams
from datagrams import ACTIVE, INACTIVE, STOPPED

# A larger gap in the loop counts does not come from lost datagrams: another control loop is sending.
_STEPS_MAX = 1000


class Controller:
    """Accepts command datagrams and answers each accepted one.

    With `rate_hz` the clock advances the plant; otherwise the loop counts of the commands do. The enable line of
    the actuators is on while the state is active; the watchdog switches it off. After `stuck_after` loop counts the
    plant moves on, but its sensors repeat their last reading."""

    def __init__(self, make_plant, actuators, watchdog_s, rate_hz=None, say=print, stuck_after=None):
        self._stuck_after = stuck_after
        self._followed = 0
        self._reading = None
        self._make_plant = make_plant
        self._actuators = actuators
        self._watchdog_s = watchdog_s
        self._rate_hz = rate_hz
        self._say = say
        self._plant = None
        self._period_s = None
        self.state = INACTIVE
        self._status = datagrams.FOLLOWS_DATAGRAMS if rate_hz is None else 0
        self._sequence = 0
        self._discarded = 0
        self._newest = 0
        self._loop_count = 0
        self._command_m = [0.0] * actuators
        self._alive_at_s = None  # time of the last change of the loop count
        self._stepped_at_s = None

    def take(self, data, now_s):
        """Returns the bytes of the answer, or None for a rejected datagram."""
        try:
            command = datagrams.decode_command(data)
            if len(command.displacement_m) != self._actuators:
                raise datagrams.NotADatagram(f"{len(command.displacement_m)} actuators; this rig has {self._actuators}")
        except datagrams.NotADatagram as defect:
            if self._discarded == 0:
                self._say(f"rejected datagram: {defect}; later ones are only counted")
            self._discarded += 1
            return None
        # A controller that is not active may start again with any sequence number.
        begins = self.state != ACTIVE and command.request == INACTIVE
        if not begins and not _is_newer(command.sequence, self._newest):
            self._discarded += 1
            return None
        self._newest = command.sequence
        self._obey(command, now_s)
        return self._measurement(now_s)

    def advance(self, now_s):
        """Advances the plant by the clock, if it has one, and checks that the control loop of the site runs."""
        if self.state == ACTIVE and self._watchdog_s and now_s - self._alive_at_s > self._watchdog_s:
            self._status |= datagrams.WATCHDOG_EXPIRED
            self._enter(STOPPED, f"watchdog: the control loop of the site did not run for {self._watchdog_s} s")
        if self.state == ACTIVE and self._rate_hz is not None:
            while now_s - self._stepped_at_s >= 1.0 / self._rate_hz:
                self._plant.step(self._command_m)
                self._stepped_at_s += 1.0 / self._rate_hz

    def _obey(self, command, now_s):
        if command.request == INACTIVE:
            self._status &= ~datagrams.WATCHDOG_EXPIRED
            self._make_new_plant(command)
            self._enter(INACTIVE, "requested by the site")
        elif command.request == STOPPED:
            self._enter(STOPPED, "requested by the site")
        elif self.state == INACTIVE and self._plant is not None:
            self._command_m = list(command.displacement_m)
            self._loop_count = command.loop_count
            self._stepped_at_s = self._alive_at_s = now_s
            self._enter(ACTIVE, "requested by the site")
        if self.state == ACTIVE:
            self._follow(command, now_s)

    def _make_new_plant(self, command):
        period_s = command.control_period_ns * 1e-9 if self._rate_hz is None else 1.0 / self._rate_hz
        if self.state == INACTIVE and self._plant is not None and period_s == self._period_s:
            return
        self._plant = self._make_plant(period_s)
        self._period_s = period_s

    def _follow(self, command, now_s):
        """Executes the command of this datagram. Lost commands are interpolated linearly."""
        loops = (command.loop_count - self._loop_count) & 0xFFFFFFFF
        if loops > 0:
            self._alive_at_s = now_s
            self._followed += loops
        if self._rate_hz is None:
            steps = min(loops, _STEPS_MAX)
            for step in range(1, steps + 1):
                if step == steps:
                    self._plant.step(command.displacement_m)
                else:
                    self._plant.step([a + (b - a) * step / steps
                                      for a, b in zip(self._command_m, command.displacement_m)])
        self._loop_count = command.loop_count
        self._command_m = list(command.displacement_m)

    def _enter(self, state, why):
        if state == self.state:
            return
        if state == ACTIVE:
            self._say("enable on")
        elif self.state == ACTIVE:
            self._say(f"enable off: {why}")
        self.state = state

    def _measurement(self, now_s):
        self._sequence = (self._sequence + 1) & 0xFFFFFFFF
        if self._stuck_after is None or self._followed < self._stuck_after or self._reading is None:
            self._reading = ((self._plant.displacement_m, self._plant.force_n) if self._plant
                             else ([0.0] * self._actuators, [0.0] * self._actuators))
        displacement_m, force_n = self._reading
        return datagrams.encode_measurement(
            datagrams.Measurement(self._sequence, self._newest, self.state, self._status, self._discarded,
                                  int(now_s * 1e9), displacement_m, force_n))


def _is_newer(sequence, than):
    """For 32-bit counts that wrap around."""
    return 0 < (sequence - than) & 0xFFFFFFFF < 0x80000000
