"""Cede decides how a vehicle crosses an unsignalized intersection.

The controller is here; environments are in `cede.envs`, recordings in `cede.data`, the bridge to
SUMO in `cede.sumo`.
"""

from ._cede import (
    Approach,
    Conflict,
    Contract,
    Decision,
    Drive,
    Error,
    Fault,
    Junction,
    JunctionBuilder,
    Policy,
    Prediction,
    Reason,
    Shield,
    Track,
    Vehicle,
    __version__,
)

__all__ = [
    "Approach",
    "Conflict",
    "Contract",
    "Decision",
    "Drive",
    "Error",
    "Fault",
    "Junction",
    "JunctionBuilder",
    "Policy",
    "Prediction",
    "Reason",
    "Shield",
    "Track",
    "Vehicle",
    "__version__",
]
