"""Interruption by Ctrl-C or SIGTERM at places of the program's choice: an exception out of a signal can be lost inside a library."""
import signal

_signals = []


def listen():
    """Notes signals from here on."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda given, _: _signals.append(given))


def check():
    """Raises KeyboardInterrupt after a signal."""
    if _signals:
        raise KeyboardInterrupt
