"""Loss, duplication, reordering and delay of datagrams, repeatable by a seed."""

import heapq
import random


class UnreliableNetwork:
    def __init__(self, loss=0.0, duplication=0.0, reordering=0.0, delay_s=0.0, seed=0):
        self._loss = loss
        self._duplication = duplication
        self._reordering = reordering
        self._delay_s = delay_s
        self._random = random.Random(seed)
        self._under_way = []  # heap of (due, number, datagram)
        self._number = 0
        self._overtaken = None  # sent after the next one

    def send(self, datagram, now_s):
        if self._random.random() < self._loss:
            return
        if self._overtaken is None and self._random.random() < self._reordering:
            self._overtaken = datagram
            return
        copies = 2 if self._random.random() < self._duplication else 1
        for _ in range(copies):
            self._put(datagram, now_s)
        if self._overtaken is not None:
            self._put(self._overtaken, now_s)
            self._overtaken = None

    def due(self, now_s):
        """Returns the datagrams that have arrived by now."""
        arrived = []
        while self._under_way and self._under_way[0][0] <= now_s:
            arrived.append(heapq.heappop(self._under_way)[2])
        return arrived

    def next_due_s(self):
        return self._under_way[0][0] if self._under_way else None

    def _put(self, datagram, now_s):
        self._number += 1
        heapq.heappush(self._under_way, (now_s + self._delay_s, self._number, datagram))
