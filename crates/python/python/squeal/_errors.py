"""Exceptions: their text is the one line that the program prints, and what it names stands in attributes."""

from __future__ import annotations


#: Most letters of a value in a line; chosen: arrays and data frames would be pages.
_LONGEST = 300


class SquealError(Exception):
    """What is wrong, in one line; the attributes that do not apply are None."""

    #: File or folder.
    path: str | None
    #: Field of a case, as ``table "name".key``.
    field: str | None
    #: Argument of a function.
    argument: str | None
    #: Value that was found.
    value: str | None
    #: Values that are allowed, in words: where nothing else says them those of the line.
    allowed: str | None

    def __init__(
        self,
        text: str,
        *,
        path: str | None = None,
        field: str | None = None,
        argument: str | None = None,
        value: str | None = None,
        allowed: str | None = None,
    ) -> None:
        super().__init__(text)
        self.path, self.field, self.argument = path, field, argument
        _, is_said, said = text.rpartition("; allowed: ")
        self.value, self.allowed = value, said if allowed is None and is_said else allowed


class ArgumentError(SquealError, ValueError):
    """An argument whose value is not allowed: `argument`, `value`, `allowed`."""


class CaseError(SquealError, ValueError):
    """A case or a brake that is not valid: `path`, and mostly `field`, `value`, `allowed`."""


class FileError(SquealError, ValueError):
    """A file that cannot be read, or is none of the formats: `path`."""


class FolderError(SquealError, OSError):
    """A folder of another study, one in use, damaged, or that cannot be written: `path`, None where it is several of them, as parts with a gap."""


class MissingCaseError(CaseError, FileNotFoundError):
    """A case file that is not there: `path`."""


class MissingFileError(FileError, FileNotFoundError):
    """A file that is not there: `path`."""


class MissingFolderError(FolderError, FileNotFoundError):
    """A folder, or a file in it, that is not there: `path`."""


class SolveError(SquealError):
    """A system or a reduction that has no answer."""


class SingularPencilError(SolveError, ArithmeticError):
    """Matrices of which every number is an eigenvalue."""


class TooLargeError(SquealError, MemoryError):
    """A computation that takes more memory than there is."""


class CaseWarning(UserWarning):
    """What the user of a case should know, as what a file leaves to be guessed."""


class FailureWarning(UserWarning):
    """Eigenvalues or samples that have failed, or a reduced brake that is not the whole one."""


def refused(argument: str, value: object, allowed: str) -> ArgumentError:
    """The exception for a value of an argument that is not allowed."""
    said = " ".join(str(value).split())
    said = said if len(said) <= _LONGEST else f"{said[:_LONGEST]} .."
    return ArgumentError(f"{argument} = {said}; allowed: {allowed}", argument=argument, value=said, allowed=allowed)
