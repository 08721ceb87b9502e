"""Reasons for which a calibration ends early; each with the exit code of the program."""


class Problem(Exception):
    """A message for the user and the exit code: 2 input, 3 files, 5 a run went bad, 6 interrupted."""

    def __init__(self, message, code=2):
        super().__init__(message)
        self.code = code


class OutOfBudget(Exception):
    """The runs or minutes of the budget are used up."""
