"""The rooms of classes, as far as tournaments need them; without that feature there are none."""

from typing import Any

from app.feature import Feature
from app.storage.errors import NotFound
from app.viewer.shared_stage import SharedStage


class RoomDirectory:
    """Finds rooms, their stages, and the participants who started runs. Thread-safe."""

    def __init__(self, classroom: Feature | None) -> None:
        """Use the classroom feature, which has the rooms; None if it is left out."""
        # By its attributes alone: importing its classes would make it a part of this feature.
        self._classroom: Any = classroom

    @property
    def is_there(self) -> bool:
        """Whether the classroom feature, which has the rooms, is not left out."""
        return self._classroom is not None

    def get(self, code: str) -> Any:
        """Return a room by its code as it was typed.

        Raises:
            NotFound: if there is none.
        """
        if self._classroom is None:
            raise NotFound(f"there is no room {code!r}: this server has no classroom")
        return self._classroom.rooms.get(code)

    def owner_of(self, run_id: str) -> str | None:
        """Return room code and seed of the participant who started a run, as `CODE SEED`."""
        if self._classroom is None:
            return None
        owner: str | None = self._classroom.rooms.owner_of(run_id)
        return owner

    def codes(self) -> list[str] | None:
        """Return the codes of all rooms; None without the classroom feature."""
        return None if self._classroom is None else list(self._classroom.rooms.codes())

    def stage_of(self, code: str) -> SharedStage | None:
        """Return the stage of a room; None if it is not open."""
        stage: SharedStage | None = None
        if self._classroom is not None:
            stage = self._classroom.stages.of(code)
        return stage
