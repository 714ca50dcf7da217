"""What-ifs of cards on a server that has left out their feature."""

import pytest

from app.features.classroom.what_ifs import WhatIfs
from app.storage.errors import NotFound
from hexapods.runs.config import training_config


def test_without_the_feature_a_card_that_asks_a_what_if_is_refused() -> None:
    with pytest.raises(NotFound, match="answers no what-ifs"):
        WhatIfs(None).ask(training_config(gait="left-right-origin", steps=5), "a client")
