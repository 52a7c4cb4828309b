"""Waiting in tests: for a condition, for as long as there is progress.

A machine that is busy with other work is slow, and may stand still for seconds. A test must not fail for that. So a
wait has no fixed duration:

- A wait ends with an error after STALLED_S seconds without progress. Progress is processor time used by the programs
that
  the test has started: every tick, byte and log line of theirs costs some.
- Time in which the test itself did not run is not counted: between two looks at the condition at most LOOK_S seconds
are.
- A world at full speed uses processor time for ever, so a wait for a condition also ends after LONGEST_S counted
seconds.
  A wait for the end of a program does not. ctest's TIMEOUT bounds everything.

Some tests have to be quicker than a time limit of the server, such as a lease. `quicker_than` repeats them where the
machine was too slow for that.
"""
import contextlib
import os
import resource
import select
import subprocess
import sys
import time

STALLED_S, LONGEST_S, LOOK_S = 20.0, 180.0, 0.25
PATIENT = ("--timeout", "600")  # of evoctl
LATE_HELLO = "no Hello was received within"  # the refusal of a client that sends its Hello too late
ATTEMPTS_MAX = 5


def descendants(process="self"):
    """The ids of all processes below one."""
    with contextlib.suppress(OSError):  # it has ended
        for thread in os.listdir(f"/proc/{process}/task"):
            with open(f"/proc/{process}/task/{thread}/children") as children:
                for child in children.read().split():
                    yield child
                    yield from descendants(child)


def processor_time_s(process):
    """Of a process and of those of its children that have ended."""
    with contextlib.suppress(OSError), open(f"/proc/{process}/stat") as stat:
        return sum(map(int, stat.read().rsplit(")", 1)[1].split()[11:15])) / os.sysconf("SC_CLK_TCK")
    return 0.0


def used_by_programs_s():
    """The processor time of all programs that this test has started."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime + sum(map(processor_time_s, descendants()))


class Wait:
    """One wait. The test calls check() between two looks at its condition."""

    def __init__(self, what, stalled_s=STALLED_S, longest_s=LONGEST_S):
        self.what, self.stalled_s, self.longest_s = what, stalled_s, longest_s
        self.counted_s = self.progress_s = self.next_look_s = 0.0  # the last two: points in counted time
        self.first_used_s = self.used_s = used_by_programs_s()
        self.checked = time.monotonic()

    def check(self):
        """Raises AssertionError where the wait has to end."""
        now = time.monotonic()
        self.counted_s += min(now - self.checked, LOOK_S)
        self.checked = now
        if self.counted_s < self.next_look_s:
            return
        self.next_look_s = self.counted_s + 1
        used_s = used_by_programs_s()
        if used_s > self.used_s:
            self.used_s, self.progress_s = used_s, self.counted_s
        idle_s = self.counted_s - self.progress_s
        if idle_s > self.stalled_s or self.counted_s > self.longest_s:
            raise AssertionError(
                f"did not happen within {self.counted_s:.0f} s: {self.what}; meanwhile the programs under test used "
                f"{self.used_s - self.first_used_s:.2f} s of processor time, none in the last {idle_s:.0f} s")


def until(condition, what, pause_s=0.005, **bounds):
    """The first true value of condition(); bounds are those of Wait."""
    wait = Wait(what, **bounds)
    while not (value := condition()):
        wait.check()
        time.sleep(pause_s)
    return value


def receive(connection, bytes_max, what="bytes from the server"):
    """The next bytes of a socket, in the clear or of TLS; none at its end."""
    poller = select.poll()
    poller.register(connection, select.POLLIN)

    def readable():
        return (hasattr(connection, "pending") and connection.pending()) or poller.poll(1000 * LOOK_S)
    if not readable():
        until(readable, what, pause_s=0)
    return connection.recv(bytes_max)


def communicate(process, input=None):
    """As Popen.communicate: what a program prints until it ends."""
    wait = Wait(f"the end of {process.args}", longest_s=float("inf"))
    while True:
        try:
            return process.communicate(input, timeout=LOOK_S)
        except subprocess.TimeoutExpired:
            input = None  # it is on its way
            wait.check()


def ended(process):
    """The status with which a program ends, which it does by itself or has been asked to."""
    until(lambda: process.poll() is not None, f"the end of {process.args}", longest_s=float("inf"))
    return process.returncode


def run(words, *, input=None, capture_output=False, check=False, **options):
    """As subprocess.run."""
    if capture_output:
        options.update(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    options.setdefault("stdin", subprocess.PIPE if input is not None else None)
    with subprocess.Popen(words, **options) as process:
        try:
            output, errors = communicate(process, input)
        except BaseException:
            process.kill()
            raise
    done = subprocess.CompletedProcess(process.args, process.returncode, output, errors)
    if check:
        done.check_returncode()
    return done


class Laps:
    """Measures the longest time between two calls of lap()."""

    def __init__(self):
        self.longest_s, self.began = 0.0, time.monotonic()

    def lap(self):
        now = time.monotonic()
        self.longest_s, self.began = max(self.longest_s, now - self.began), now


def quicker_than(limit_s, attempt):
    """The result of attempt(lap), which has to be quicker than a time limit of the server.

    An attempt that fails after it has taken longer than that proves nothing, and is repeated. A quicker one that fails
    is a failure, and so is the last of ATTEMPTS_MAX. The time between two calls of lap() counts, from the beginning to
    the end, so an attempt may last as long as it likes if it calls lap() often enough.
    """
    for number in range(1, ATTEMPTS_MAX + 1):
        laps = Laps()
        try:
            return attempt(laps.lap)
        except (AssertionError, EOFError, OSError) as fault:
            laps.lap()
            if laps.longest_s < limit_s or number == ATTEMPTS_MAX:
                raise
            print(f"attempt {number} took {laps.longest_s:.1f} s, longer than {limit_s:g} s, and is repeated: "
                  f"{fault!r}",
                  file=sys.stderr, flush=True)
