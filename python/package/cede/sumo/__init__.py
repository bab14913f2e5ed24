"""Drives vehicles of any SUMO network: `python -m cede.sumo NET.net.xml …`."""

from ._bridge import Bridge, Settings
from ._demand import write_demand
from ._measures import Measures
from ._network import Movement, Network, Site

__all__ = ["Bridge", "Measures", "Movement", "Network", "Settings", "Site", "write_demand"]
