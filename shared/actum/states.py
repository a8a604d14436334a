"""The states that a service reports of itself, and how one is recognised in a status."""

from enum import StrEnum


class State(StrEnum):
    """The kind of a service's state. The text of a state begins with its kind; a reason or remarks may follow."""

    RUNNING = "running"
    SOURCE_ENDED = "source ended"
    CAMERA_LOST = "camera lost"
    NO_MODEL = "no model"
    MODEL_NOT_RENEWED = "model not renewed"
    NOTHING_TO_DO = "nothing to do"
    UNKNOWN_ACTIONS = "settings name actions that the model does not know"

    def because(self, detail: str) -> str:
        """Return the text of this state with its cause."""
        return f"{self}: {detail}"

    def noting(self, remark: str) -> str:
        """Return the text of this state with a remark, such as what a model cannot do."""
        return f"{self}; {remark}"

    @classmethod
    def of(cls, text: str) -> "State | None":
        """Return the kind of the state that a status reports, None for a state that is not listed here."""
        return next((state for state in cls if text.startswith(state)), None)

    @staticmethod
    def remarks(text: str) -> list[str]:
        """Return the remarks in the text of the state `running`, an empty list for any other state."""
        kind, *remarks = text.split("; ")
        return remarks if kind == State.RUNNING else []
