"""Cede decides how a vehicle crosses an unsignalized intersection.

The controller is here; environments are in `cede.envs` and registered by this import, recordings in `cede.data`, the bridge to
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
    View,
    __version__,
)
from ._register import register
from .evaluation import evaluate


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
    "View",
    "__version__",
    "evaluate",
]

register()
