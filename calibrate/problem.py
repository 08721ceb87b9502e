"""Reasons for which a calibration ends early; each with the exit code of the program."""


class Problem(Exception):
    """A message for the user and the exit code: 2 input, 3 files, 5 a run went bad, 6 interrupted."""

    def __init__(self, message, code=2):
        super().__init__(message)
        self.code = code


def code_of(error):
    """The exit code for an OSError of a file that is read: 2 if there is none of its name, else 3."""
    return 2 if isinstance(error, FileNotFoundError) else 3


class OutOfBudget(Exception):
    """The runs or minutes of the budget are used up."""
