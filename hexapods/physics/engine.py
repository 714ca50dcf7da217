"""Check of the loaded MuJoCo version: results repeat to the last bit only in one version of it.

Two distributions, `mujoco` and `mujoco-core`, have files of the same names: the one that was
installed last is loaded, whatever the metadata of the other one says.
"""

import warnings

import mujoco

PINNED = "4.0.0"
"""The version of `mujoco-core` in pyproject.toml."""
REMEDY = "pip uninstall mujoco mujoco-core && pip install mujoco-core==" + PINNED


def loaded_version() -> str:
    """Return the version of the engine itself; with that of its bindings where both differ."""
    engine, bindings = str(mujoco.mj_versionString()), str(mujoco.__version__)
    return engine if engine == bindings else f"{engine} with the bindings of {bindings}"


def mismatch() -> str | None:
    """Return which engine is loaded and what to do, a sentence; None if it is the pinned one."""
    loaded = loaded_version()
    if loaded == PINNED:
        return None
    return (
        f"the MuJoCo that is loaded is {loaded}, and has to be {PINNED}: results differ from "
        "those elsewhere. The packages mujoco and mujoco-core share their files, and the one "
        f"installed last is loaded; install the right one alone: {REMEDY}"
    )


def warn_of_mismatch() -> None:
    """Warn if the engine is not the pinned one."""
    warning = mismatch()
    if warning is not None:
        warnings.warn(warning, RuntimeWarning, stacklevel=2)
