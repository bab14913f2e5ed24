"""Vehicles of a running simulation, driven by Cede."""

from __future__ import annotations

import contextlib
import math
import os
import random
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from .._cede import Contract, Drive, Error, Policy, Shield, Track
from ._demand import write_demand
from ._measures import CRITICAL, STANDING, STUCK, Measures
from ._network import MOST_CANDIDATES, STOPS, Movement, Network, Place, Site, Stretch
from ._persons import Person, Walk, nearest, walks_at, zones_of

DRIVERS = ("cede", "profile", "sumo")
INTENTS = ("indicated", "hidden", "known")
INDICATED = 80.0
"""Metres before its line from which a vehicle that turns has its indicators on; SUMO: 100 m."""
_INDICATORS = {0: "straight", 1: "right", 2: "left"}
"""The turn that SUMO's signals say."""

AT_LINE = 2.0
"""Metres before its line from which a vehicle that stands is at it."""
HEADWAY = 1.0
"""Seconds that a vehicle wishes to keep to its leader."""
STANDSTILL = 2.5
"""Metres to the leader at rest, SUMO's `minGap`, which SUMO's gaps leave out."""
LIVELY, FREE = 3.0, 14.0
"""Acceleration (m/s²) from rest, and the speed (m/s) at which it ends, with nothing ahead."""
SMOOTH = 0.5
"""Seconds in which a vehicle gets as fast as it may be: less makes it jerk."""
SETTING_OFF = 4.0
"""Speed (m/s), at least, at which a vehicle is expected to cross a junction."""
SPARE, SHRINKS = 6.0, 2.0
"""Metres by which a plan passes whoever comes, without which a vehicle that turns does not enter:
in the bend it is slower than the plan, which then gets tighter; and for each metre to its line as
many more: on its way there it slows down, and the plan gets tighter already."""
SOFT = 2.5
"""Braking (m/s²) on the last metre to the line."""
CREEPING, NOSE = 3.0, 2.0
"""Speed (m/s) and metres beyond its line up to which a vehicle has not really set off."""
LATE = 0.8
"""Share of the contract's braking with which a vehicle stops that would rather go."""
FREE_WAY = 1e5
"""Metres to spare that say that nobody is in the way."""
ROOM = 2.0
"""Metres to the vehicle ahead beyond the junction, without which a vehicle waits before it."""
BUSIEST = 1e5
"""Vehicles or persons an hour and arm, at most."""
_NOTHING = 0
"""Speed mode: nothing of SUMO's own acts on the vehicle."""
_OWN = 31
"""Speed mode: SUMO's default."""


@dataclass
class Settings:
    """What a run is told, as the options of `python -m cede.sumo`."""

    driver: str = "cede"
    share: float = 1.0
    ego: int | None = None
    contract: Contract | None = None
    shield: bool = True
    step: float = 0.1
    time: float = 600.0
    seed: int = 0
    gui: bool = False
    policy: Policy | None = None
    stops: bool = True
    """Whether stop signs are obeyed; otherwise only the shield stops a vehicle."""
    intent: str = "indicated"
    """Whether others' turns are `"indicated"`, so that their indicators are believed, `"known"`, as
    by radio, or `"hidden"` until they are inside."""

    def check(self) -> None:
        """Raise what is out of its range."""
        if self.driver not in DRIVERS:
            raise Error(f"driver = `{self.driver}` is none of: {', '.join(DRIVERS)}")
        if self.intent not in INTENTS:
            raise Error(f"intent = `{self.intent}` is none of: {', '.join(INTENTS)}")
        for name, low, high in (("share", 0.0, 1.0), ("time", 1.0, 1e6)):
            value = getattr(self, name)
            if not low <= value <= high:
                raise Error(f"{name} = {value} is outside [{low:g}, {high:g}]")
        period = (self.contract or Contract()).period
        if not math.isclose(self.step, period):
            raise Error(f"step = {self.step} s is not the contract's period, {period} s")


@dataclass
class Car:
    """A vehicle of the simulation."""

    name: str
    number: int
    length: float
    """Metres."""
    chosen: bool
    """Whether it is one of those that are driven, or measured beside them."""
    lane: str = ""
    position: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    waited: float = 0.0
    delay: float = 0.0
    site: Site | None = None
    movement: Movement | None = None
    """The way that it takes, or has taken last."""
    followed: str = ""
    """The lane on which its path is known: it leads to no other junction than that."""
    placed: float = -1.0
    """The time (s) of what follows."""
    on_path: bool = False
    front: float = 0.0
    """Place (m) of its front bumper along its movement."""
    s: float = 0.0
    """Arc length (m) of its centre on its path."""
    rate: float = 1.0
    """Metres of the path for each metre of the front bumper."""
    known: set[int] = field(default_factory=set)
    """Numbers of the tracks that its shield has seen last."""
    shield: Shield | None = None
    approach: Any = None
    stopped: bool = False
    """Whether it has stopped where it has to."""
    tight: bool = False
    """Whether its plan stops, or goes with little to spare."""


@dataclass
class Bridge:
    """Runs a simulation of `network` and drives a share of its vehicles.

    `routes` is a file of routes; without it, `demand` vehicles and `pedestrians` persons an hour
    come from every arm.
    """

    network: Network
    settings: Settings
    routes: str | os.PathLike[str] | None = None
    demand: float | None = None
    pedestrians: float = 0.0
    measures: Measures = field(default_factory=Measures)
    _now: float = field(default=0.0, init=False)
    """Seconds since the start."""

    def run(self) -> Measures:
        """Run to the end; the measures are returned."""
        for _ in self.steps():
            pass
        return self.measures

    def steps(self) -> Iterator[float]:
        """Run step by step: the time (s) after each, when all vehicles have been commanded.

        In between, `self.sumo` is the module `libsumo` (`traci` with a window) of the running
        simulation, `self.cars` are its vehicles, and `self.measures` what has been counted.
        """
        self._check()
        with tempfile.TemporaryDirectory() as folder:
            routes = self.routes
            if routes is None:
                routes = os.path.join(folder, "demand.rou.xml")
                settings = self.settings
                write_demand(
                    self.network.net,
                    routes,
                    per_hour=self.demand,
                    pedestrians=self.pedestrians,
                    time=settings.time,
                    seed=settings.seed,
                )
            elif not os.path.isfile(routes):
                raise Error(f"{os.fspath(routes)}: no such file of routes")
            self._start(os.fspath(routes))
            closed = self.sumo.FatalTraCIError, self.sumo.TraCIException
            try:
                yield from self._loop()
            except closed as wrong:
                raise Error(f"SUMO is gone after {self._now:.1f} s: {wrong}") from wrong
            finally:
                with contextlib.suppress(*closed):
                    self.sumo.close()

    def _check(self) -> None:
        self.settings.check()
        if (self.routes is None) == (self.demand is None):
            raise Error("give either routes or a demand")
        if self.routes is not None and self.pedestrians:
            raise Error("pedestrians come with a demand: in a file of routes, write them there")
        for name, value in (("demand", self.demand), ("pedestrians", self.pedestrians)):
            least = 1.0 if name == "demand" else 0.0
            if value is not None and not least <= value <= BUSIEST:
                raise Error(f"{name} = {value:g} is outside [{least:g}, {BUSIEST:g}] an hour")

    def _start(self, routes: str) -> None:
        if self.settings.gui:
            import sumolib
            import traci as sumo

            # That of the package, wherever it is installed.
            program = sumolib.checkBinary("sumo-gui")
        else:
            # It may warn of other packages, on the stream where the numbers go.
            with contextlib.redirect_stdout(sys.stderr):
                import libsumo as sumo

            program = "sumo"
        self.sumo = sumo
        options = {
            "--net-file": self.network.file,
            "--route-files": routes,
            "--step-length": str(self.settings.step),
            "--step-method.ballistic": "true",
            "--seed": str(self.settings.seed),
            "--collision.action": "warn",
            "--collision.check-junctions": "true",
            "--collision.mingap-factor": "0",
            "--time-to-teleport": "-1",
            "--no-step-log": "true",
            "--no-warnings": "true",
            "--default.speeddev": "0",
        }
        try:
            sumo.start([program, *(word for pair in options.items() for word in pair)])
        except Exception as wrong:
            raise Error(f"SUMO does not start: {wrong}") from wrong

    def _loop(self) -> Iterator[float]:
        self.cars: dict[str, Car] = {}
        self.persons: dict[str, Person] = {}
        fastest = self.network.fastest
        self._contract = self.settings.contract or contract_named("sumo", fastest)
        self._braking = self._contract.ego_braking
        self._random = random.Random(self.settings.seed)
        self._numbers = 0
        self._now = 0.0
        steps = round(self.settings.time / self.settings.step)
        for step in range(1, steps + 1):
            self.sumo.simulationStep()
            self._now = step * self.settings.step
            self._account()
            began = time.process_time()
            decisions = self.measures.decisions
            self._drive_all()
            if self.measures.decisions > decisions:
                self.measures.seconds += time.process_time() - began
            yield self._now
        self._finish()

    # What has happened since the last step.

    def _account(self) -> None:
        simulation, measures = self.sumo.simulation, self.measures
        for name in simulation.getDepartedIDList():
            self.cars[name] = self._new(name)
        for name in simulation.getArrivedIDList():
            car = self.cars.pop(name)
            measures.arrived += 1
            measures.delays.append(car.delay)
        for collision in simulation.getCollisions():
            pair = frozenset((collision.collider, collision.victim))
            if not pair <= self.cars.keys():
                # With a person: these are counted below, wherever they are.
                continue
            measures.collisions.add(pair)
            if any(self.cars[name].chosen for name in pair):
                measures.ego_collisions.add(pair)
        for car in self.cars.values():
            self._read(car)
        self._account_persons()

    def _account_persons(self) -> None:
        on_foot, measures = self.sumo.person, self.measures
        if not self.persons and on_foot.getIDCount() == 0:
            return
        # Whoever rides is not on foot.
        there = {name for name in on_foot.getIDList() if not on_foot.getVehicle(name)}
        for name in self.persons.keys() - there:
            del self.persons[name]
        for name in sorted(there):
            person = self.persons.get(name)
            if person is None:
                person = self.persons[name] = Person(name)
                measures.persons += 1
            person.moved()
            person.x, person.y = on_foot.getPosition(name)
            person.speed = on_foot.getSpeed(name)
            standing = person.speed < STANDING
            person.waits = person.waits + self.settings.step if standing else 0.0
            measures.stood += self.settings.step * standing
            measures.person_wait = max(measures.person_wait, person.waits)
        for car in self.cars.values():
            self._collide(car)

    def _collide(self, car: Car) -> None:
        """Count the persons that a vehicle touches."""
        x, y = self.sumo.vehicle.getPosition(car.name)
        near = [p for p in self.persons.values() if abs(p.x - x) < 10.0 > abs(p.y - y)]
        if not near:
            return
        vehicle, measures = self.sumo.vehicle, self.measures
        heading = math.radians(90.0 - vehicle.getAngle(car.name))
        size = car.length, vehicle.getWidth(car.name)
        for person in near:
            if person.touches((x, y), heading, size):
                pair = frozenset((car.name, person.name))
                measures.person_collisions.add(pair)
                if car.chosen:
                    measures.ego_person_collisions.add(pair)

    def _new(self, name: str) -> Car:
        vehicle, settings = self.sumo.vehicle, self.settings
        length, width = vehicle.getLength(name), vehicle.getWidth(name)
        if length > self.network.length or width > self.network.width:
            raise Error(
                f"vehicle {name} is {length} m × {width} m: the junctions are prepared for "
                f"{self.network.length} m × {self.network.width} m "
                "(--length and --width, or those of Network)"
            )
        chosen = self._random.random() < settings.share
        if settings.ego is not None:
            chosen = chosen and self.measures.driven < settings.ego
        self.measures.driven += chosen
        speed = vehicle.getSpeed(name)
        return Car(name, self._number(), length, chosen, speed=speed)

    def _read(self, car: Car) -> None:
        vehicle, step = self.sumo.vehicle, self.settings.step
        before, was = car.speed, car.acceleration
        car.lane = vehicle.getLaneID(car.name)
        car.position = vehicle.getLanePosition(car.name)
        car.speed = vehicle.getSpeed(car.name)
        car.acceleration = (car.speed - before) / step
        car.waited = car.waited + step if car.speed < STANDING else 0.0
        car.delay = vehicle.getTimeLoss(car.name) + vehicle.getDepartDelay(car.name)
        self.measures.max_wait = max(self.measures.max_wait, car.waited)
        if car.chosen:
            self._measure(car, before, was)

    def _measure(self, car: Car, before: float, was: float) -> None:
        lateral = 0.0
        if car.on_path:
            curvature = car.movement.at(car.movement.curvature, car.front)
            lateral = (car.speed * car.rate) ** 2 * curvature
        metres = (before + car.speed) / 2 * self.settings.step
        self.measures.moved(metres, self.settings.step, (was, car.acceleration), lateral)

    def _finish(self) -> None:
        simulation, measures = self.sumo.simulation, self.measures
        measures.demanded = measures.arrived + len(self.cars) + len(simulation.getPendingVehicles())
        measures.stuck = sum(car.waited >= STUCK for car in self.cars.values())

    # Who is where.

    def _drive_all(self) -> None:
        driven: list[Car] = []
        for car in self.cars.values():
            # Of one that is not driven the path is known while it stays in its lane.
            if car.chosen or car.lane != car.followed:
                self._follow(car)
                if car.chosen and car.on_path:
                    driven.append(car)
        if not driven or self.settings.driver == "sumo":
            return
        there: dict[str, list[Car]] = {car.site.name: [] for car in driven}
        using = self.network.using
        for car in self.cars.values():
            for name in using.get(car.lane, ()):
                if name in there:
                    there[name].append(car)
        self._tracks: dict[tuple[str, str], Track | None] = {}
        persons = list(self.persons.values())
        sites = {car.site.name: car.site for car in driven if persons}
        stride = 0.95 * self.network.pace * self.settings.step
        walks = {
            name: walks_at(site, persons, stride, self._number) for name, site in sites.items()
        }
        for car in driven:
            tracks = self._relevant(car, there[car.site.name])
            tracks += self._on_foot(car, walks.get(car.site.name, {}))
            self._drive(car, tracks)

    def _on_foot(self, car: Car, walks: dict[int, list[Walk]]) -> list[Track]:
        """Who keeps the vehicle out of its zones with crossings."""
        found: dict[int, Walk] = {}
        for crossing in car.site.crossings:
            there = walks.get(crossing.path)
            for past, *zone in zones_of(car.site, car.movement, crossing) if there else ():
                if car.s < past:
                    found.update({walk.number: walk for walk in nearest(there, zone)})
        vehicle = car.site.junction.vehicle
        return [
            Track(w.number, w.path, vehicle(w.path, w.s, w.person.speed), kind="pedestrian")
            for w in found.values()
        ]

    def _number(self) -> int:
        self._numbers += 1
        return self._numbers % 65536

    def _relevant(self, car: Car, there: list[Car]) -> list[Track]:
        """The others at the junction without those that others hold back.

        Who has left every zone with the vehicle's path is left out, too. Nobody overtakes in a
        lane: who is behind others on its way to the junction reaches no zone before them, and is
        left out if they may take every path that it may take. In the vehicle's own lane only the
        one just ahead is told; whoever is behind the vehicle is held back by it.
        """
        site, entering = car.site, self.network.entering
        left = site.left[car.movement.path]
        lanes: dict[str, list[Car]] = {}
        relevant, held = [], set()
        for other in there:
            lane = other.lane
            if other is car:
                continue
            if site is not entering.get(lane):
                if self._stands_in_entry(other, site):
                    held.add(other.movement.incoming)
                if other.position < left.get(lane, math.inf):
                    relevant.append(other)
            elif lane != car.lane:
                lanes.setdefault(lane, []).append(other)
        if site is entering.get(car.lane):
            ahead = [o for o in there if o.lane == car.lane and o.position > car.position]
            if ahead:
                relevant.append(min(ahead, key=lambda other: other.position))
        tracks = [self._track(site, other) for other in relevant]
        known = [track for track in tracks if track is not None]
        queues = [self._foremost(car, q) for lane, q in lanes.items() if lane not in held]
        return known + [track for queue in queues for track in queue]

    def _foremost(self, car: Car, queue: list[Car]) -> list[Track]:
        """Of those in one lane, whoever may take a path that nobody ahead of it may take.

        Nobody behind one that stands: until that one sets off, it is in the way. But the next one
        is told if it goes after the vehicle once it arrives, which then knows that it came first.
        """
        site = car.site
        foremost: list[Track] = []
        taken: set[int] = set()
        stands = False
        for other in sorted(queue, key=lambda other: -other.position):
            if stands and not _in_order(car, other):
                break
            track = self._track(site, other)
            # A movement is the same way for all.
            ways = {path % len(site.movements) for path, _ in track.candidates} if track else set()
            if not ways <= taken:
                foremost.append(track)
                taken |= ways
            if stands:
                break
            stands = other.speed < STANDING
        return foremost

    def _stands_in_entry(self, car: Car, site: Site) -> bool:
        """Whether a vehicle stands in the junction with its rear still in its lane."""
        if car.site is not site or car.speed >= STANDING:
            return False
        self._place(car)
        inside = car.movement.stretches[1].start
        return car.on_path and car.front - car.length < inside <= car.front

    def _track(self, site: Site, car: Car) -> Track | None:
        """The vehicle as others see it at this step; `None` if it is on no path."""
        key = (site.name, car.name)
        if key not in self._tracks:
            self._tracks[key] = self._new_track(site, car)
        return self._tracks[key]

    def _new_track(self, site: Site, car: Car) -> Track | None:
        """The vehicle on every path that its lane belongs to."""
        self._place(car)
        places = site.on_lane[car.lane]
        if len(places) > 1 and car.site is site:
            places = self._expected(car, places) or places
        places = places[:MOST_CANDIDATES]
        if car.position < site.shared.get(car.lane, 0.0):
            candidates, rate = _on_all(car, places)
        else:
            candidates, rate = _on_each(car, places)
        if not candidates:
            return None
        (path, s), *others = candidates
        vehicle = site.junction.vehicle(path, s, car.speed * rate)
        return Track(car.number, path, vehicle, or_on=others)

    def _expected(self, car: Car, places: list[Place]) -> list[Place]:
        """Those of the movements of its lane on which others have to expect the vehicle."""
        if self.settings.intent == "known" or car.lane == car.movement.outgoing:
            return [place for place in places if place[0] is car.movement]
        if self.settings.intent == "hidden" or car.s < car.movement.line - INDICATED:
            return places
        turn = _INDICATORS.get(self.sumo.vehicle.getSignals(car.name) & 3)
        return places if turn is None else [p for p in places if p[0].direction == turn]

    def _follow(self, car: Car) -> None:
        """Bring a vehicle's own path up to date, and its place on it."""
        ahead = self.network.entering.get(car.lane)
        car.followed = car.lane if ahead is None or ahead is car.site else ""
        if car.movement is not None:
            self._place(car)
            if car.on_path and (ahead in (None, car.site) or car.s < car.movement.clear):
                return
        if car.shield is not None and (ahead is not None or not car.on_path):
            self._release(car)
        if ahead is not None and ahead is not car.site:
            self._enter(car, ahead)

    def _place(self, car: Car) -> None:
        """Bring a vehicle's place on its own path up to date."""
        if car.placed != self._now and car.movement is not None:
            stretch = car.movement.on.get(car.lane)
            car.on_path = stretch is not None and self._put(car, car.movement, stretch)

    def _enter(self, car: Car, site: Site) -> None:
        movement, stretch = self._way(car, site)
        if movement is not None and self._put(car, movement, stretch):
            car.site, car.movement, car.on_path = site, movement, True
            car.stopped = not (self.settings.stops and movement.state in STOPS)

    def _put(self, car: Car, movement: Movement, stretch: Stretch) -> bool:
        """Put a vehicle where it is on a movement; whether that is on its path."""
        car.placed = self._now
        car.front = front = _front(car, stretch)
        car.s, car.rate = movement.place(front)
        return front >= 0.0 and car.s < movement.length - 1.0

    def _way(self, car: Car, site: Site) -> tuple[Movement, Stretch] | tuple[None, None]:
        """The movement that the vehicle's route takes from its lane."""
        vehicle = self.sumo.vehicle
        route, index = vehicle.getRoute(car.name), vehicle.getRouteIndex(car.name)
        following = route[index + 1] if 0 <= index < len(route) - 1 else None
        for movement, stretch in site.on_lane[car.lane]:
            if movement.incoming == car.lane and movement.to_edge == following:
                return movement, stretch
        return None, None

    def _release(self, car: Car) -> None:
        """Hand the vehicle back to SUMO."""
        self.sumo.vehicle.setSpeedMode(car.name, _OWN)
        self.sumo.vehicle.setSpeed(car.name, -1.0)
        car.shield = car.approach = None
        car.known = set()

    # What it does.

    def _drive(self, car: Car, tracks: list[Track]) -> None:
        ego = car.site.junction.vehicle(car.movement.driven, car.s, car.speed * car.rate)
        if car.shield is None and not self._take_over(car, ego, tracks):
            return
        self._forget(car, {track.number for track in tracks})
        wanted = self._profile(car)
        measures = self.measures
        measures.decisions += 1
        if self.settings.shield:
            if car.approach is not None:
                decision = car.approach.decide(self._now, ego, tracks, wanted)
            else:
                decision = car.shield.filter(self._now, ego, tracks, wanted)
            wanted = decision.acceleration
            self._judge(car, decision)
            if decision.no_plan:
                # Nothing is certain any more: it leaves no faster than the bend lets it.
                wanted = min(wanted, self._allowed(car))
            measures.shielded += decision.cause != "policy"
            measures.no_plan += decision.no_plan
            measures.breaches += decision.breach is not None
        elif car.approach is not None:
            wanted = min(wanted, car.approach.proposal(ego, tracks))
        self._command(car, max(0.0, ego.speed + wanted * self.settings.step))

    @staticmethod
    def _judge(car: Car, decision: Any) -> None:
        """Note whether the plan stops, or has too little to spare; not of one that stands."""
        if decision.plan:
            short = max(0.0, car.movement.line - car.s)
            car.tight = decision.margin < SPARE + SHRINKS * short
        else:
            car.tight = car.speed >= STANDING and decision.margin < FREE_WAY

    def _command(self, car: Car, speed: float) -> None:
        """Have the centre of the vehicle as fast as this (m/s) at the end of the step."""
        moved = (car.speed + speed) / 2 * self.settings.step
        _, rate = car.movement.place(car.front + moved)
        self.sumo.vehicle.setSpeed(car.name, speed / rate)

    @staticmethod
    def _forget(car: Car, numbers: set[int]) -> None:
        """Nothing is hidden here: who is not seen any more is gone."""
        for number in car.known - numbers:
            (car.approach or car.shield).forget(number)
        car.known = numbers

    def _take_over(self, car: Car, ego: Any, tracks: list[Track]) -> bool:
        """Take control over, if there is a safe plan."""
        shield = Shield(car.site.junction, car.movement.driven, self._contract)
        if self.settings.shield:
            try:
                shield.ready(self._now, ego, tracks)
            except Error:
                self.measures.refused += 1
                return False
        car.shield = shield
        if self.settings.driver == "cede":
            drive = Drive(self.settings.policy, self._contract)
            car.approach = drive.enter(car.site.junction, car.movement.driven)
        self.sumo.vehicle.setSpeedMode(car.name, _NOTHING)
        return True

    def _profile(self, car: Car) -> float:
        """The acceleration (m/s²) of a plain profile: limits, curves, stop signs, the leader."""
        movement, braking = car.movement, self.network.braking
        wanted = min(LIVELY * (1.0 - (car.speed / FREE) ** 4), self._allowed(car))
        if not car.stopped:
            short = movement.line - car.s
            car.stopped = car.speed < STANDING and short < AT_LINE
            wanted = min(wanted, _stopping(car.speed, short - 0.2, braking))
        if self._waits(car) or self._lets_pass(car):
            wanted = min(wanted, self._stop(car))
        leader = self.sumo.vehicle.getLeader(car.name, 50.0)
        other = self.cars.get(leader[0]) if leader else None
        # SUMO also names those who are about to merge: they are the shield's matter.
        if other is None or other.lane not in movement.on:
            return wanted
        if _blocks(car, other, leader[1]):
            wanted = min(wanted, self._stop(car))
        return min(wanted, self._behind(car, other, leader[1]))

    def _stop(self, car: Car) -> float:
        """The acceleration (m/s²) that stops at the line, as late as the shield lets it."""
        return _stopping(car.speed, car.movement.line - car.s, LATE * self._braking)

    def _waits(self, car: Car) -> bool:
        """Whether its plan has too little to spare in the bend, if it goes, and it can still stop.

        Where it cannot any more, to go is better than to go late.
        """
        movement = car.movement
        if not car.tight or movement.direction == "straight" or car.s > movement.line:
            return False
        room = movement.line + NOSE - car.s
        return car.speed**2 < 2 * room * self._braking

    def _lets_pass(self, car: Car) -> bool:
        """Whether it hardly moves yet, and one of SUMO's drivers has set off across its way.

        SUMO's drivers do not look at the right of way of a vehicle that stands.
        """
        if car.speed > CREEPING or not -AT_LINE < car.s - car.movement.line < NOSE:
            return False
        here = (
            other
            for other in self.cars.values()
            if other.shield is None and other.site is car.site and other.speed >= STANDING
        )
        return any(self._inside(other) and _crosses(car, other) for other in here)

    def _inside(self, car: Car) -> bool:
        """Whether a vehicle is past its line."""
        self._place(car)
        return car.on_path and car.s > car.movement.line

    @staticmethod
    def _allowed(car: Car) -> float:
        """The acceleration (m/s²) that limits and bends allow, there and a little ahead."""
        movement = car.movement
        here = movement.at(movement.allowed, car.front)
        ahead = movement.at(movement.allowed, car.front + car.speed * SMOOTH)
        return (min(here, ahead) - car.speed * car.rate) / SMOOTH

    def _behind(self, car: Car, leader: Car, gap: float) -> float:
        """The intelligent driver model behind a leader."""
        closing = car.speed - leader.speed
        if closing > 0.0 and gap + STANDSTILL < CRITICAL * closing:
            self.measures.critical += 1
        wished = car.speed * (HEADWAY + closing / (2 * math.sqrt(LIVELY * self.network.braking)))
        return LIVELY * (
            1.0 - ((STANDSTILL + max(0.0, wished)) / (STANDSTILL + max(gap, -1.0))) ** 2
        )


def _on_all(car: Car, places: list[Place]) -> tuple[list[tuple[int, float]], float]:
    """Paths and arc lengths (m) of a vehicle where its ways are still one, and its rate on them."""
    movement, stretch = places[0]
    if car.movement is not None and car.movement.incoming == car.lane:
        s, rate = car.s, car.rate
    else:
        s, rate = movement.place(_front(car, stretch))
    if car.shield is not None:
        return [(movement.driven, s) for movement, _ in places], rate
    return [(movement.path, s) for movement, _ in places], rate


def _on_each(car: Car, places: list[Place]) -> tuple[list[tuple[int, float]], float]:
    """Paths and arc lengths (m) of a vehicle on each of its ways, and its rate on the last one."""
    candidates, rate = [], 1.0
    for movement, stretch in places:
        if movement is car.movement:
            front, s, rate = car.front, car.s, car.rate
        else:
            front = _front(car, stretch)
            s, rate = movement.place(front)
        if front >= 0.0 and s < movement.length:
            candidates.append((movement.driven if car.shield else movement.path, s))
    return candidates, rate


def _in_order(car: Car, other: Car) -> bool:
    """Whether two go in the order of their arrival."""
    if other.shield is None:
        return False
    conflict = car.site.junction.conflict(car.movement.driven, other.movement.driven)
    return conflict.priority == "first-come"


def _crosses(car: Car, other: Car) -> bool:
    """Whether a zone that another has not left yet lies ahead of a vehicle."""
    zones = car.site.junction.conflict(car.movement.driven, other.movement.path).zones
    return any(
        kind == "crossing" and car.s < ego[0] and other.s < theirs[1] for kind, ego, theirs in zones
    )


def _front(car: Car, stretch: Stretch) -> float:
    """Place (m) of the front bumper along the movement of a stretch."""
    return stretch.start + car.position * stretch.scale


def _blocks(car: Car, leader: Car, gap: float) -> bool:
    """Whether a vehicle before its line would find no room behind `leader` beyond the junction."""
    movement = car.movement
    if car.s > movement.line:
        return False
    beyond = movement.stretches[-1].start + car.length
    time = (beyond - car.front) / max(car.speed, SETTING_OFF)
    return car.front + gap + leader.speed * time < beyond + ROOM


def _stopping(speed: float, room: float, braking: float) -> float:
    """The acceleration (m/s²) that stops in `room` metres: none before it must brake by then."""
    if room < 1.0:
        return (math.sqrt(2 * SOFT * max(room, 0.0)) - speed) / 0.3
    needed = speed**2 / (2 * room)
    return -needed if needed > 0.8 * braking else math.inf


def contract_named(name: str, fastest: float | None = None) -> Contract:
    """A contract by its name, with the errors of a vehicle's place on its path here.

    SUMO moves a vehicle's front bumper along its lanes; where these bend, its centre is a little
    faster or slower than the front. `"sumo"` is an all-way stop's with the brakes of SUMO's own
    vehicles: it can follow as near as they do. Its plans clear a junction at an acceleration that
    leaves bends comfortable. A vehicle arrives where the second one of a queue has not been yet, so
    that others see it arrive. Nobody is faster than `fastest` (m/s), where that is known.
    """
    errors = {"position_error": 0.05, "speed_error": 0.1}
    if name == "sumo":
        queues = {"distance": 5.0, "patience": 30}
        drives = {"ego_go": 2.0, "ego_braking": 4.5, "ego_emergency": 8.0}
        if fastest is not None:
            drives |= {"ego_max_speed": fastest, "other_max_speed": fastest}
        return Contract("all-way-stop", **drives, precedence=queues, **errors)
    try:
        known = Contract(name)
    except Error as wrong:
        raise Error(f"{wrong}, sumo") from None
    return Contract(name, **{field: max(getattr(known, field), errors[field]) for field in errors})
