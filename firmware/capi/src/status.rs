//! Numbered results of every function.

use core::ffi::CStr;

/// What became of a call. The numbers are stable: none changes its meaning, new ones are added.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_status {
    /// Done.
    Ok = 0,

    /// A pointer that must not be null is.
    NullPointer = 1,
    /// A pointer is not a multiple of its type's alignment.
    Misaligned = 2,
    /// Not an object of this kind: never initialised, moved, or in use by a call that is not finished.
    NotInitialised = 3,
    /// The object's bytes have changed between two calls.
    Corrupt = 4,
    /// The junction of this approach is another one now.
    Stale = 5,
    /// An array is larger than memory.
    TooLarge = 6,
    /// The FPU does not round to nearest, or does not keep subnormal numbers.
    FloatEnvironment = 7,

    /// A numbered choice, as a class or a part, has a number that is none.
    UnknownChoice = 10,
    /// More than CEDE_MAX_TRACKS tracks.
    TooManyTracks = 11,
    /// A track without a candidate, or with more than CEDE_MAX_CANDIDATES.
    CandidateCount = 12,
    /// A number of the observation, or an acceleration, is out of its range.
    InputFault = 13,

    /// The weights do not begin with CEDE.
    WeightsMagic = 20,
    /// The weights' checksum does not fit: a bit has changed.
    WeightsChecksum = 21,
    /// The weights have a version, feature set or perspective that this library does not know.
    WeightsUnknown = 22,
    /// The weights' length does not fit their layers.
    WeightsShape = 23,
    /// A weight is not finite or too large.
    WeightsOutOfRange = 24,
    /// This library was built without the embedded policy.
    WeightsNotEmbedded = 25,
    /// A sum of a network of integers could exceed 32 bits.
    WeightsOverflow = 26,

    /// A number of the contract is out of its range.
    ContractOutOfRange = 30,

    /// A route needs two points that are apart.
    RouteTooFewPoints = 40,
    /// More than CEDE_MAX_ROUTE_POINTS points.
    RouteTooManyPoints = 41,
    /// A coordinate is not a number, or more than 8192 m from the origin.
    RouteOutOfRange = 42,

    /// The junction has no path.
    JunctionNoPaths = 50,
    /// More than CEDE_MAX_PATHS paths.
    JunctionTooManyPaths = 51,
    /// More than CEDE_MAX_POINTS points of all paths.
    JunctionTooManyPoints = 52,
    /// There is no such path.
    JunctionUnknownPath = 53,
    /// A side of a footprint is not in (0, 40] m.
    JunctionFootprint = 54,
    /// The tolerance is not in [0, 1] m.
    JunctionTolerance = 55,
    /// A path turns by more than 90 degrees in one point.
    JunctionKink = 56,
    /// A path is longer than 512 m.
    JunctionTooLong = 57,
    /// A path comes back to itself.
    JunctionReturns = 58,
    /// A line is not on its path.
    JunctionLine = 59,
    /// A path was given the right of way over itself.
    JunctionRightOfWay = 60,
    /// The junction is not built yet.
    JunctionNotBuilt = 61,
    /// The junction is built: nothing can be added.
    JunctionBuilt = 62,
    /// A speed limit is not in (0, 100] m/s, or not on its path.
    JunctionSpeedLimit = 63,
    /// More than CEDE_MAX_LIMITS speed limits of a path.
    JunctionTooManyLimits = 64,
    /// The lateral acceleration is not in (0, 20] m/s^2.
    JunctionLateral = 65,
    /// The highest speed of pedestrians is not in (0, 10] m/s.
    JunctionPace = 66,

    /// The junction has no such path to enter by.
    EnterPath = 70,
    /// The contract's position_error is too large for a lane that the ego shares with another path.
    EnterPositionError = 71,
    /// The place from which a path is in sight is not on it.
    SightFrom = 72,
    /// The speed of those who are out of sight is not in (0, 100] m/s.
    SightSpeed = 73,
    /// More than CEDE_MAX_SIGHTS paths that are partly out of sight.
    TooManySights = 74,

    /// The ego's state cannot be trusted: control cannot be handed over.
    NotReadyFault = 80,
    /// No plan is safe: control cannot be handed over.
    NotReadyNoPlan = 81,

    /// What this version of the library has no number for.
    Other = 255,
}

impl From<Result<(), cede_status>> for cede_status {
    fn from(result: Result<(), cede_status>) -> Self {
        result.err().unwrap_or(Self::Ok)
    }
}

/// What a number of a status says.
pub(crate) const STATUS: &[(i32, &CStr)] = &[
    (cede_status::Ok as i32, c"done"),
    (cede_status::NullPointer as i32, c"a pointer is null"),
    (cede_status::Misaligned as i32, c"a pointer is misaligned"),
    (
        cede_status::NotInitialised as i32,
        c"not an object of this kind: never initialised, moved, or in use",
    ),
    (
        cede_status::Corrupt as i32,
        c"the object's bytes have changed between two calls",
    ),
    (
        cede_status::Stale as i32,
        c"the junction of this approach is another one now",
    ),
    (
        cede_status::TooLarge as i32,
        c"an array is larger than memory",
    ),
    (
        cede_status::FloatEnvironment as i32,
        c"the FPU does not round to nearest, or does not keep subnormal numbers",
    ),
    (
        cede_status::UnknownChoice as i32,
        c"a numbered choice has a number that is none",
    ),
    (cede_status::TooManyTracks as i32, c"too many tracks"),
    (
        cede_status::CandidateCount as i32,
        c"a track without a candidate, or with too many",
    ),
    (
        cede_status::InputFault as i32,
        c"a number of the observation, or an acceleration, is out of its range",
    ),
    (
        cede_status::WeightsMagic as i32,
        c"not a weights file: it does not begin with CEDE",
    ),
    (
        cede_status::WeightsChecksum as i32,
        c"the weights' checksum does not fit: they are damaged",
    ),
    (
        cede_status::WeightsUnknown as i32,
        c"a version, feature set or perspective of weights that is not known",
    ),
    (
        cede_status::WeightsShape as i32,
        c"the weights' layers do not fit their length or the limits",
    ),
    (
        cede_status::WeightsOutOfRange as i32,
        c"a weight is not finite or too large",
    ),
    (
        cede_status::WeightsNotEmbedded as i32,
        c"built without the embedded policy",
    ),
    (
        cede_status::WeightsOverflow as i32,
        c"a sum of the integer network could exceed 32 bits",
    ),
    (
        cede_status::ContractOutOfRange as i32,
        c"a number of the contract is out of its range",
    ),
    (
        cede_status::RouteTooFewPoints as i32,
        c"a route needs two points that are apart",
    ),
    (
        cede_status::RouteTooManyPoints as i32,
        c"more points than a route may have",
    ),
    (
        cede_status::RouteOutOfRange as i32,
        c"a coordinate is not a number or too far from the origin",
    ),
    (
        cede_status::JunctionNoPaths as i32,
        c"a junction without paths",
    ),
    (
        cede_status::JunctionTooManyPaths as i32,
        c"more paths than a junction has room for",
    ),
    (
        cede_status::JunctionTooManyPoints as i32,
        c"more points than a junction has room for",
    ),
    (
        cede_status::JunctionUnknownPath as i32,
        c"there is no such path",
    ),
    (
        cede_status::JunctionFootprint as i32,
        c"a side of a footprint is out of its range",
    ),
    (
        cede_status::JunctionTolerance as i32,
        c"the tolerance is out of its range",
    ),
    (
        cede_status::JunctionKink as i32,
        c"a path turns by more than 90 degrees in one point",
    ),
    (cede_status::JunctionTooLong as i32, c"a path is too long"),
    (
        cede_status::JunctionReturns as i32,
        c"a path comes back to itself",
    ),
    (
        cede_status::JunctionLine as i32,
        c"a line is not on its path",
    ),
    (
        cede_status::JunctionRightOfWay as i32,
        c"a path with the right of way over itself",
    ),
    (
        cede_status::JunctionNotBuilt as i32,
        c"the junction is not built yet",
    ),
    (
        cede_status::JunctionBuilt as i32,
        c"the junction is built: nothing can be added",
    ),
    (
        cede_status::JunctionSpeedLimit as i32,
        c"a speed limit out of its range, or not on its path",
    ),
    (
        cede_status::JunctionTooManyLimits as i32,
        c"more speed limits than a path has room for",
    ),
    (
        cede_status::JunctionLateral as i32,
        c"the lateral acceleration is out of its range",
    ),
    (
        cede_status::JunctionPace as i32,
        c"the highest speed of pedestrians is out of its range",
    ),
    (
        cede_status::EnterPath as i32,
        c"the junction has no such path to enter by",
    ),
    (
        cede_status::EnterPositionError as i32,
        c"position_error is too large for a lane that the ego shares",
    ),
    (
        cede_status::SightFrom as i32,
        c"a path is in sight from a place that is not on it",
    ),
    (
        cede_status::SightSpeed as i32,
        c"the speed of those out of sight is out of its range",
    ),
    (
        cede_status::TooManySights as i32,
        c"more paths partly out of sight than there is room for",
    ),
    (
        cede_status::NotReadyFault as i32,
        c"not ready: the ego's state cannot be trusted",
    ),
    (
        cede_status::NotReadyNoPlan as i32,
        c"not ready: no plan is safe",
    ),
    (
        cede_status::Other as i32,
        c"what this version has no number for",
    ),
];
