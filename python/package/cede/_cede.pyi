"""The part of the package that is written in Rust."""

import os
from collections.abc import Sequence
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
FEATURES: list[str]
SCALES: list[float]

class Error(ValueError):
    """Something that Cede was given cannot be used; the text names field, value and range."""

    field: str
    """The number that is to blame, as in `ego.braking`; there only if it is one number."""
    value: float

@final
class Contract:
    """What the shield assumes of the world. A contract that exists is valid.

    The numbers are read as attributes, and given as keywords over those of `base`.
    """

    period: float
    latency: float
    jitter: float
    position_error: float
    speed_error: float
    slack: float
    ego_max_speed: float
    ego_acceleration: float
    ego_go: float
    ego_braking: float
    ego_emergency: float
    ego_lag: float
    ego_gain: float
    ego_disturbance: float
    other_max_speed: float
    other_acceleration: float
    other_braking: float
    follower_reaction: float
    follower_braking: float

    def __new__(
        cls,
        base: Literal["worst-case", "all-way-stop"] = "worst-case",
        *,
        period: float = ...,
        latency: float = ...,
        jitter: float = ...,
        position_error: float = ...,
        speed_error: float = ...,
        slack: float = ...,
        ego_max_speed: float = ...,
        ego_acceleration: float = ...,
        ego_go: float = ...,
        ego_braking: float = ...,
        ego_emergency: float = ...,
        ego_lag: float = ...,
        ego_gain: float = ...,
        ego_disturbance: float = ...,
        other_max_speed: float = ...,
        other_acceleration: float = ...,
        other_braking: float = ...,
        follower_reaction: float = ...,
        follower_braking: float = ...,
        precedence: dict[str, float] | str | None = ...,
    ) -> Contract: ...
    def replace(self, **numbers: float | dict[str, float] | str | None) -> Contract:
        """Return this contract with other numbers."""
    @staticmethod
    def from_toml(text: str) -> Contract:
        """The contract that is written as TOML."""
    @staticmethod
    def load(path: str | os.PathLike[str]) -> Contract:
        """The contract of a TOML file."""
    def to_toml(self) -> str:
        """What `from_toml` reads."""
    def to_dict(self) -> dict[str, Any]:
        """The numbers by their keywords."""
    @property
    def precedence(self) -> dict[str, float] | None:
        """The rule of precedence that the others keep, if they do."""

@final
class Policy:
    """A network that drives. Its weights stay in memory to the program's end."""

    @staticmethod
    def embedded() -> Policy:
        """The policy that ships: trained on synthetic scenarios alone."""
    @staticmethod
    def load(path: str | os.PathLike[str]) -> Policy:
        """The policy of a `.cede` file."""
    @staticmethod
    def from_onnx(
        path: str | os.PathLike[str],
        features: str | None = None,
        perspective: str | None = None,
    ) -> Policy:
        """The policy of an ONNX file; `docs/formats.md` says which graphs."""
    def oriented(self, svo: float) -> Policy:
        """The same network, showing a social value orientation (degrees, 0 to 90).

        0 is an egoist, 45 as it learned, 90 an altruist.
        """
    @property
    def svo(self) -> float:
        """The orientation that it shows (degrees)."""
    @property
    def features(self) -> str: ...
    @property
    def perspective(self) -> str: ...
    @property
    def width(self) -> int:
        """Neurons of a hidden layer."""

@final
class Vehicle:
    """A vehicle as it is sensed on a path: m, m/s, m, m, rad."""

    def __new__(cls, s: float, speed: float, x: float, y: float, heading: float) -> Vehicle: ...
    @property
    def s(self) -> float: ...
    @property
    def speed(self) -> float: ...
    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def heading(self) -> float: ...

@final
class Track:
    """Another vehicle, as tracking reports it; `or_on` has other paths that it may be on."""

    def __new__(
        cls,
        number: int,
        path: int,
        vehicle: Vehicle,
        *,
        kind: Literal["car", "lorry", "bicycle", "pedestrian"] = "car",
        or_on: Sequence[tuple[int, float]] = ...,
    ) -> Track: ...
    @property
    def number(self) -> int: ...
    @property
    def speed(self) -> float: ...
    @property
    def candidates(self) -> list[tuple[int, float]]:
        """The paths that it may be on, each with the arc length (m) there."""

@final
class JunctionBuilder:
    """Collects what a junction is built from. A call that raises changes nothing."""

    def __new__(cls, tolerance: float = 0.1, lateral: float | None = None) -> JunctionBuilder: ...
    def path(
        self,
        points: ArrayLike,
        *,
        kind: Literal["car", "lorry", "bicycle", "pedestrian"] = "car",
        length: float = 5.0,
        width: float = 2.0,
        line: float | None = None,
        control: Literal["unknown", "free", "yield", "stop", "all-way-stop"] = "unknown",
        limits: Sequence[tuple[float, float]] = ...,
        pace: float | None = None,
        order: int | None = None,
    ) -> int:
        """Add a path along `points`, shape (n, 2), in metres; its number is returned.

        `line` (m) is where a vehicle waits: it passes it only with a plan through the junction.
        `limits` are speed limits of the ego: from where on (m), and how fast (m/s).
        `pace` (m/s) is the most speed of pedestrians on it, who may turn back.
        `order` is its place in the order in which vehicles at rest take turns, by default its
        number: of two, the one with the larger place has the first turns.
        """
    def variant(
        self,
        of: int,
        kind: Literal["car", "lorry", "bicycle", "pedestrian"],
        length: float,
        width: float,
        line: float | None = None,
        order: int | None = None,
    ) -> int:
        """Add a path along the points of path `of`, for another class of vehicles."""
    def right_of_way(
        self,
        first: int,
        second: int,
        priority: Literal["first-come", "unsigned", "signed"] = "first-come",
    ) -> None:
        """Say that vehicles of path `first` have the right of way over those of path `second`.

        It counts if both arrive at once (`"first-come"`), until both rest and take turns
        (`"unsigned"`), or always (`"signed"`).
        """
    def build(self) -> Junction: ...

@final
class Junction:
    """A junction: its paths, and how each two of them meet. Prepared once for all vehicles."""

    @staticmethod
    def builder(tolerance: float = 0.1, lateral: float | None = None) -> JunctionBuilder:
        """A builder without paths. `lateral` (m/s²) is what the ego is to have at most in bends."""
    def __len__(self) -> int: ...
    @property
    def tolerance(self) -> float: ...
    def points(self, path: int) -> NDArray[np.float32]:
        """The points of a path, shape (n, 2)."""
    def length(self, path: int) -> float: ...
    def line(self, path: int) -> float:
        """Arc length (m) of the footprint's centre while a vehicle waits at its line."""
    def allowed_speed(self, path: int, s: float) -> float:
        """The speed (m/s) that limits and bends allow an ego there; infinite without them."""
    def allowed_acceleration(
        self, path: int, s: float, speed: float, response: float = 0.1
    ) -> float:
        """The largest acceleration (m/s²) with which an ego keeps to limits and bends ahead."""
    def vehicle(self, path: int, s: float, speed: float) -> Vehicle:
        """A vehicle on `path` at arc length `s` (m), exactly on it."""
    def project(self, path: int, x: float, y: float) -> float:
        """Arc length (m) of the point of `path` nearest to (x, y)."""
    def conflict(self, ego: int, other: int) -> Conflict:
        """How path `ego` meets path `other`."""

@final
class Conflict:
    """How the ego's path meets one other's."""

    @property
    def kind(self) -> Literal["crossing", "merging", "following", "none"]: ...
    @property
    def ego_conflict(self) -> float:
        """Arc length (m) of the conflict point on the ego's path."""
    @property
    def other_conflict(self) -> float: ...
    @property
    def right_of_way(self) -> Literal["ego", "other", "unsettled"]: ...
    @property
    def priority(self) -> Literal["first-come", "unsigned", "signed"]: ...
    @property
    def zones(self) -> list[tuple[str, tuple[float, float], tuple[float, float]]]:
        """Where the footprints can touch: the kind, and from where to where (m) on either path."""

@final
class Drive:
    """What drives a vehicle, at every intersection."""

    def __new__(
        cls,
        policy: Policy | None = None,
        contract: Contract | None = None,
        *,
        part: Literal["left", "other"] = "left",
        svo: float | None = None,
        estimates: bool = False,
    ) -> Drive:
        """`svo` (degrees) is what the policy shows: see `Policy.oriented`.

        `estimates`: whether the orientations of others are estimated (`Prediction.shown`).
        """

    def enter(self, junction: Junction, path: int) -> Approach:
        """Begin to approach `junction` on `path`."""

@final
class Approach:
    """One vehicle on its way through one junction."""

    def decide(
        self,
        now: float,
        ego: Vehicle,
        tracks: Sequence[Track] = ...,
        most: float | None = None,
    ) -> Decision:
        """The ego's acceleration for the period that begins `now` (s). Call it once a period.

        `most` (m/s²) is what the vehicle's own driver allows, for its speed limit or leader.
        """
    def ready(self, now: float, ego: Vehicle, tracks: Sequence[Track] = ...) -> float:
        """Metres to spare of the best plan before control is handed over; raises without one."""
    def proposal(self, ego: Vehicle, tracks: Sequence[Track] = ...) -> float:
        """What the policy alone would do (m/s²): to measure what the shield costs."""
    @property
    def plan(self) -> int | None:
        """For so many periods the remembered plan accelerates; `None` is no guarantee."""
    @property
    def contract(self) -> Contract: ...
    def set_policy(self, policy: Policy) -> None:
        """Drive with `policy` from the next decision on."""
    def set_contract(self, contract: Contract) -> None:
        """Drive within `contract` from the next decision on."""
    def set_sight(self, now: float, sights: Sequence[tuple[int, float, float]]) -> None:
        """Say how much of some paths is in sight at `now` (s), for the decision at that time.

        Each is a path, the arc length (m) from which it is in sight, and the most speed (m/s) of
        those before it. Name a path whose view may ever be limited from the first decision on.
        """
    def forget(self, number: int) -> None:
        """Say that the track with this number is known not to be there any more."""

@final
class Shield:
    """The shield of one vehicle at one junction: filters the proposals of any driver."""

    def __new__(cls, junction: Junction, path: int, contract: Contract | None = None) -> Shield: ...
    def filter(
        self, now: float, ego: Vehicle, tracks: Sequence[Track], proposal: float
    ) -> Decision:
        """`proposal` (m/s²) if it is safe, else the nearest that is. Call it once a period."""
    def ready(self, now: float, ego: Vehicle, tracks: Sequence[Track] = ...) -> float:
        """Metres to spare of the best plan before control is handed over; raises without one."""
    @property
    def plan(self) -> int | None: ...
    def set_sight(self, now: float, sights: Sequence[tuple[int, float, float]]) -> None:
        """Say how much of some paths is in sight at `now` (s), for the decision at that time.

        Each is a path, the arc length (m) from which it is in sight, and the most speed (m/s) of
        those before it. Name a path whose view may ever be limited from the first decision on.
        """
    def forget(self, number: int) -> None: ...

@final
class Decision:
    """The ego's acceleration, and why it is what it is. `str` is one line for a log."""

    @property
    def acceleration(self) -> float: ...
    @property
    def cause(self) -> Literal["policy", "shielded", "fallback"]:
        """Who decided."""
    @property
    def action(self) -> Literal["nearest", "remembered"] | None:
        """What the shield did, if it decided."""
    @property
    def reason(self) -> Reason | None:
        """What the proposal would have led to, if the shield decided."""
    @property
    def margin(self) -> float:
        """Metres to spare of the best plan that follows."""
    @property
    def plan(self) -> int | None:
        """For so many periods the plan that follows accelerates; then it brakes."""
    @property
    def no_plan(self) -> bool:
        """Whether no plan is safe: the guarantee has ended."""
    @property
    def breach(self) -> Literal["ego"] | int | None:
        """Whose motion exceeds the contract: the ego's, or that of a track."""
    @property
    def fault(self) -> Fault | None:
        """What is wrong with the inputs, or else why neither policy nor shield decided."""
    @property
    def unwatched(self) -> int | None:
        """A track that matters and for which there is no room."""
    @property
    def headroom(self) -> dict[str, Room]:
        """How near each monitored condition of the contract is to its limit.

        `ego-position` (m), `ego-speed` (m/s), `other-position` (m), `other-speed` (m/s),
        `offset` (m), `heading` (a cosine), `period` (s); those that were compared.
        """
    @property
    def prediction(self) -> Prediction | None:
        """What the policy thinks of the other that restricts the ego most."""

@final
class Room:
    """What is left of a tolerance before a condition of the contract is broken."""

    @property
    def left(self) -> float:
        """In the condition's unit; below 0 it is broken."""
    @property
    def share(self) -> float:
        """Of the most that can be left: 1 in the middle of what is allowed, 0 at its end."""
    @property
    def track(self) -> int | None:
        """The track that has least left; `None` is the ego or the call."""

@final
class Reason:
    """Why a proposal is refused."""

    @property
    def kind(self) -> Literal["arrival", "entry", "stop", "hidden"]: ...
    @property
    def other(self) -> int | None: ...
    @property
    def path(self) -> int | None:
        """The path on which somebody may be out of sight."""
    @property
    def numbers(self) -> dict[str, float]:
        """`arrives` and `clears` (s), `gap` and `needs` (m), or `available` and `needs` (m)."""

@final
class Fault:
    """Why an input cannot be trusted, or that nothing is safe."""

    @property
    def kind(self) -> Literal["no-plan", "input", "backwards", "off-period", "proposal"]: ...
    @property
    def track(self) -> int | None:
        """Number of the track whose number is out of range; `None` is the ego."""
    @property
    def value(self) -> float | None: ...
    @property
    def range(self) -> tuple[float, float] | None: ...

@final
class Prediction:
    """What the policy thinks of one other."""

    @property
    def other(self) -> int: ...
    @property
    def svo(self) -> float:
        """The ego's social value orientation towards it (rad), in [0, π/2]."""
    @property
    def acceleration(self) -> float:
        """The acceleration (m/s²) that is expected of it."""
    @property
    def shown(self) -> Estimate | None:
        """The orientation that it has shown, if estimates are wanted."""

@final
class Estimate:
    """The social value orientation that an other has shown, by what it did."""

    @property
    def svo(self) -> float:
        """Its orientation (rad): π/4 if nothing is known."""
    @property
    def confidence(self) -> float:
        """From 0, nothing is known, to 1, no doubt is left."""
    @property
    def acceleration(self) -> float:
        """The acceleration (m/s²) that is expected of it."""

@final
class Dataset:
    """A site's recordings and the encounters in them; its length is that of the latter."""

    @staticmethod
    def synthetic(encounters: int = 1000, seed: int = 0) -> Dataset: ...
    @staticmethod
    def load(folder: str | os.PathLike[str], site: str = "EP0") -> Dataset: ...
    @property
    def site(self) -> str: ...
    def __len__(self) -> int: ...
    def recording_columns(self) -> dict[str, Any]: ...
    def encounter_columns(self, split: str = "all") -> dict[str, Any]: ...
    def state_columns(self, split: str = "all") -> dict[str, Any]: ...
    def criticality_columns(self, split: str = "all") -> dict[str, Any]: ...
    def route(self, encounter: int, vehicle: int, split: str = "all") -> NDArray[np.float32]:
        """The route of a vehicle: points (m), shape (n, 2)."""
    def map_lanelets(
        self,
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64], list[int], float | None]]:
        """The lanelets: left and right bound (n, 2), indices of the successors, limit in m/s."""
    def map_lines(self) -> list[tuple[str, NDArray[np.float64]]]:
        """The lines of the map: what each is, and its points, shape (n, 2)."""

@final
class View:
    """What a driver written in Python sees when it decides."""

    @property
    def step(self) -> int: ...
    @property
    def role(self) -> Literal["left", "other"]: ...
    @property
    def s(self) -> float: ...
    @property
    def speed(self) -> float: ...
    @property
    def distance(self) -> float:
        """Metres to the conflict point; negative past it."""
    @property
    def other_s(self) -> float: ...
    @property
    def other_speed(self) -> float: ...
    @property
    def other_distance(self) -> float: ...
    @property
    def svo(self) -> float: ...
    @property
    def observation(self) -> NDArray[np.float32]:
        """What the environments show a policy in this state."""

@final
class Batch:
    """Encounters stepped together; `cede.envs` is what to use."""

    def __new__(
        cls,
        dataset: Dataset,
        split: str,
        shown: int,
        *,
        mode: str,
        reward: str,
        autoreset: str,
        threads: int = 1,
    ) -> Batch: ...
    @property
    def sizes(self) -> tuple[int, int]: ...
    @property
    def encounters(self) -> int: ...
    def seed(self, seed: int) -> None: ...
    def place(self, place: int, encounter: int) -> None: ...
    def observe(self, observations: NDArray[np.float32]) -> None: ...
    def step(
        self,
        actions: NDArray[np.float32],
        observations: NDArray[np.float32],
        rewards: NDArray[np.float32],
        terminated: NDArray[np.bool_],
        truncated: NDArray[np.bool_],
        final_observations: NDArray[np.float32],
        outcomes: NDArray[np.uint8],
    ) -> None: ...
    def scene(self, place: int) -> tuple[int, list[list[float]]]: ...
    def states(self, place: int) -> list[list[float]]: ...
    def view(self, place: int, vehicle: int, observation: NDArray[np.float32]) -> None:
        """Write what one of the two vehicles sees."""

def driver_names() -> list[str]: ...
def evaluate(
    driver: Any,
    name: str,
    dataset: Dataset,
    split: str,
    mode: str,
    until: str,
    partner: str,
    shield: Contract | None,
    seed: int,
    threads: int,
) -> tuple[str, str]: ...
def replay(
    driver: Any,
    name: str,
    dataset: Dataset,
    split: str,
    encounter: int,
    until: str,
    shield: Contract | None,
    seed: int,
) -> tuple[dict[str, NDArray[Any]], str]: ...
