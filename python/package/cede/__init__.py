"""Cede decides how a vehicle crosses an unsignalized intersection.

The controller is here, and `evaluate`. Importing this registers the environments of `cede.envs`
with Gymnasium. Recordings are in `cede.data`, the bridge to SUMO is in `cede.sumo`.
"""

from ._cede import (
    Approach,
    Conflict,
    Contract,
    Decision,
    Drive,
    Error,
    Estimate,
    Fault,
    Junction,
    JunctionBuilder,
    Policy,
    Prediction,
    Reason,
    Room,
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
    "Estimate",
    "Fault",
    "Junction",
    "JunctionBuilder",
    "Policy",
    "Prediction",
    "Reason",
    "Room",
    "Shield",
    "Track",
    "Vehicle",
    "View",
    "__version__",
    "evaluate",
]

register()
