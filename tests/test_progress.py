"""Progress: a few plain lines in a log, a live line in a terminal."""

import io

import pytest

from warpsph import progress
from warpsph.progress import Progress, clock, si


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def now(monkeypatch):
    """A wall clock that only moves when told."""
    wall = [100.0]
    monkeypatch.setattr(progress, "_now", lambda: wall[0])
    return wall


def feed(report, wall, steps, seconds_per_step):
    report.start(8e-6)
    for step in range(1, steps + 1):
        wall[0] += seconds_per_step
        report.update(time=8e-6 * step / steps, step=step, dt=1.25e-9, energy_error=-2e-13, rate=4.2e6)
    report.stop()


@pytest.mark.parametrize(
    ("steps", "seconds", "least", "most"),
    [(1000, 0.001, 1, 2), (1000, 0.1, 10, 20), (100_000, 0.36, 10, 120), (3, 100.0, 3, 3)],
)
def test_a_log_gets_few_lines(now, steps, seconds, least, most):
    stream = io.StringIO()
    feed(Progress(stream), now, steps, seconds)
    lines = stream.getvalue().splitlines()
    assert least <= len(lines) <= most
    assert lines[-1].startswith("100 %")


def test_a_line_tells_what_matters(now, monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")
    stream = io.StringIO()
    feed(Progress(stream), now, 2, 90.0)
    first = stream.getvalue().splitlines()[0]
    for part in (
        "50 %",
        "4 µs of 8 µs",
        "0:01:30 left",
        "step 1",
        "dt 1.25 ns",
        "-2e-13",
        "4.2 M particle-steps/s",
    ):
        assert part in first


def test_resuming_counts_from_where_it_starts(now):
    stream = io.StringIO()
    report = Progress(stream)
    report.start(10.0, start_time=8.0)
    now[0] += 60.0
    report.update(time=9.0, step=5, dt=1.0, energy_error=0.0, rate=1e6)
    assert "50 %" in stream.getvalue()
    assert "0:01:00 left" in stream.getvalue()


def test_a_terminal_gets_a_live_line(now, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "200")
    stream = Terminal()
    report = Progress(stream)
    report.message("hello [1]")
    feed(report, now, 50, 1.0)
    report.stop()
    text = stream.getvalue()
    assert "hello [1]\n" in text
    assert "100 %" in text
    assert "\x1b[?25h" in text, "the cursor is shown again"


def test_a_dumb_terminal_gets_plain_lines(now, monkeypatch):
    monkeypatch.setenv("TERM", "dumb")
    stream = Terminal()
    feed(Progress(stream), now, 3, 100.0)
    assert "\x1b" not in stream.getvalue()


def test_nothing_to_do_is_done(now):
    stream = io.StringIO()
    report = Progress(stream)
    report.start(1.0, start_time=1.0)
    report.update(time=1.0, step=0, dt=0.0, energy_error=0.0, rate=0.0)
    assert stream.getvalue().startswith("100 %")


def test_numbers_for_people():
    assert si(3.2e-6, "s") == "3.2 µs"
    assert si(0.0, "s") == "0 s"
    assert clock(3725.4) == "1:02:05"


def test_warp_says_one_line_about_compiling():
    class Inner:
        def __init__(self):
            self.said = []

        def warning(self, message, category, stacklevel):
            self.said.append(message)

        def error(self, message):
            self.said.append(message)

    stream, inner = io.StringIO(), Inner()
    warp_log = progress.WarpLog(Progress(stream), inner)
    warp_log.debug("much")
    warp_log.info("Warp 1.19 initialized:")
    warp_log.info("Module a load on device 'cpu' took 3.00 ms  (cached)")
    assert stream.getvalue() == ""
    warp_log.info("Module b load on device 'cpu' took 300.00 ms  (compiled)")
    warp_log.info("Module c load on device 'cpu' took 300.00 ms  (compiled)")
    assert stream.getvalue() == "compiling kernels (first run only) ...\n"
    warp_log.warning("careful", None)
    warp_log.error("bad")
    assert inner.said == ["careful", "bad"]
