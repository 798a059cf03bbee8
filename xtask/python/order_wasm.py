"""Puts functions of a module next to others that they resemble: packing knows only the last 32 kB, and a module has many
functions that are nearly the same.

`named(module)` gives the functions of a module names, in whose order they should stand.
"""

import collections

# Half of what the packer knows.
WINDOW = 24000
# Bytes that two functions share in a row; those that more functions share say little.
LENGTH, COMMON = 6, 32
CODE = 10


def number(module, at):
    """An unsigned number, and where it ends."""
    value = shift = 0
    while True:
        byte = module[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return value, at


def coded(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out) + bytes([value])


def functions(module):
    """The bodies of all functions."""
    at = 8
    while at < len(module):
        kind = module[at]
        length, at = number(module, at + 1)
        if kind == CODE:
            count, at = number(module, at)
            for _ in range(count):
                length, at = number(module, at)
                yield module[at : at + length]
                at += length
            return
        at += length


def order(bodies):
    """Numbers of functions: each comes after those that have most in common with it, for its length."""
    runs = [{body[k : k + LENGTH] for k in range(len(body) - LENGTH + 1)} for body in bodies]
    having = collections.defaultdict(list)
    for index, some in enumerate(runs):
        for run in some:
            having[run].append(index)
    having = {run: some for run, some in having.items() if 1 < len(some) <= COMMON}
    runs = [[run for run in some if run in having] for some in runs]
    shared, known, window, length = [0] * len(bodies), collections.Counter(), collections.deque(), 0
    left, result = set(range(len(bodies))), []
    while left:
        # Equal ones in order of their numbers, so that the same module is always made the same.
        best = max(left, key=lambda k: (shared[k] / (len(bodies[k]) + 8), len(bodies[k]), -k))
        left.remove(best)
        result.append(best)
        for run in runs[best]:
            known[run] += 1
            if known[run] == 1:
                for other in having[run]:
                    shared[other] += 1
        window.append(best)
        length += len(bodies[best])
        while length - len(bodies[window[0]]) > WINDOW:
            gone = window.popleft()
            length -= len(bodies[gone])
            for run in runs[gone]:
                known[run] -= 1
                if known[run] == 0:
                    for other in having[run]:
                        shared[other] -= 1
    return result


def named(module):
    places = {index: place for place, index in enumerate(order(list(functions(module))))}
    names = b"".join(coded(index) + b"\x06" + b"%06d" % places[index] for index in range(len(places)))
    names = coded(len(places)) + names
    content = b"\x04name" + b"\x01" + coded(len(names)) + names
    return module + b"\x00" + coded(len(content)) + content
