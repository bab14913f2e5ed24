//! A junction: it is initialised, filled with paths, built, and then asked and driven through.

use crate::detail::{cede_detail, told};
use crate::memory::{Plain, checked, read, slice, write};
use crate::object::{Storage, change, lend, make};
use crate::observation::{
    CEDE_CLASS_BICYCLE, CEDE_CLASS_CAR, CEDE_CLASS_LORRY, CEDE_CLASS_PEDESTRIAN, cede_point,
    cede_pose, class, class_number, point, pose,
};
use crate::status::cede_status;
use cede_controller::{
    ConflictKind, Control, Footprint, Junction, JunctionBuilder, JunctionError, Path, PathId,
    Priority, RightOfWay, Route, RouteConflict, RouteError, Zone,
};
use core::ffi::CStr;
use core::mem::MaybeUninit;

/// Most paths of a junction.
pub const CEDE_MAX_PATHS: usize = 12;
/// Most points of all its paths.
pub const CEDE_MAX_POINTS: usize = 192;
/// The first so many paths can be entered by the ego.
pub const CEDE_MAX_ENTRIES: usize = 3;
/// Most points of one route, before those that lie on a straight line are left out.
pub const CEDE_MAX_ROUTE_POINTS: usize = 64;
/// Most zones of two paths.
pub const CEDE_MAX_ZONES: usize = 3;

/// Most speed limits of a path.
pub const CEDE_MAX_LIMITS: usize = 4;

const _: () = assert!(CEDE_MAX_ZONES == cede_controller::junction::zone::MAX_ZONES);
const _: () = assert!(CEDE_MAX_LIMITS == cede_controller::junction::MAX_LIMITS);

/// Words of eight bytes of a cede_junction.
pub const CEDE_JUNCTION_WORDS: usize = 856;

/// A junction: its paths, and how each two of them meet. Once built it does not change; it stays where it is for as long
/// as an approach through it is used.
#[repr(C)]
pub struct cede_junction {
    /// The library's.
    pub storage: [u64; CEDE_JUNCTION_WORDS],
}

impl Storage for cede_junction {
    type Value = Site;
    const KIND: u32 = u32::from_le_bytes(*b"ceju");
}

pub(crate) type Built = Junction<CEDE_MAX_PATHS, CEDE_MAX_POINTS, CEDE_MAX_ENTRIES>;
type Builder = JunctionBuilder<CEDE_MAX_PATHS, CEDE_MAX_POINTS, CEDE_MAX_ENTRIES>;

/// A builder, and the junction in it once it is built: there is room for one of them only.
pub(crate) struct Site {
    builder: Builder,
    /// Null before.
    built: *const Built,
}

impl Site {
    // Not inlined, and written to at once: it is large, and not to be on the stack.
    #[inline(never)]
    fn begin(place: &mut MaybeUninit<Self>) {
        let place = place.as_mut_ptr();
        // SAFETY: fields of the place.
        unsafe {
            (&raw mut (*place).builder).write(Builder::new());
            (&raw mut (*place).built).write(core::ptr::null());
        }
    }

    /// The junction.
    ///
    /// # Safety
    /// The site is where it was when it was built, and stays there, unchanged, as long as `'a`.
    pub(crate) unsafe fn built<'a>(&self) -> Result<&'a Built, cede_status> {
        // SAFETY: null, or inside the site itself.
        unsafe { self.built.as_ref() }.ok_or(cede_status::JunctionNotBuilt)
    }

    fn unfinished(&mut self) -> Result<&mut Builder, cede_status> {
        if self.built.is_null() {
            Ok(&mut self.builder)
        } else {
            Err(cede_status::JunctionBuilt)
        }
    }
}

/// The largest footprint of the vehicles on a path, centred on the reference point.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct cede_footprint {
    /// Metres from bumper to bumper, in (0, 40].
    pub length: f32,
    /// Metres from side to side, in (0, 40].
    pub width: f32,
}

// SAFETY: numbers.
unsafe impl Plain for cede_footprint {}

/// How two paths meet.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_conflict_kind {
    /// Not at all.
    None = 0,
    /// They cross and part again.
    Crossing = 1,
    /// They run into one lane.
    Merging = 2,
    /// They share a lane from the start.
    Following = 3,
}

/// Who has the right of way.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_right {
    /// Not settled.
    Unsettled = 0,
    /// The ego.
    Ego = 1,
    /// The other.
    Other = 2,
}

/// When a right of way counts.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_priority {
    /// If both arrive at once: whoever arrives first goes first, as at an all-way stop.
    FirstCome = 0,
    /// Whoever arrives first, until both rest: then they take turns. Where there are no signs.
    Unsigned = 1,
    /// Whoever arrives first, as signs and markings give it: whoever gives way waits longer before they take turns.
    Signed = 2,
}

/// What obliges a vehicle to give way where it enters a junction.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum cede_control {
    /// It is not known.
    Unknown = 0,
    /// Nothing: the vehicle is on the major road, or there are no signs.
    Free = 1,
    /// It gives way.
    Yield = 2,
    /// It stops and gives way.
    Stop = 3,
    /// It stops, as everybody does: who has stopped first goes first.
    AllWayStop = 4,
}

/// A path of a junction.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_path_info {
    /// Length in m.
    pub length: f32,
    /// Arc length in m at which a vehicle waits at its line.
    pub line: f32,
    /// What a vehicle covers at most.
    pub footprint: cede_footprint,
    /// Its class, CEDE_CLASS_...
    pub vehicle_class: u8,
    /// What obliges it to give way.
    pub control: cede_control,
    /// 1 if the line was set: the ego waits there, and not in the junction.
    pub waits_at_line: u8,
    /// 0.
    pub reserved: u8,
}

/// A stretch of the ego's path and one of the other's in which they can touch; arc lengths in m. An end of 10^6 or -10^6
/// stands for a zone that goes on past the end of a path.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_zone {
    /// Arc lengths of the ego: lower end.
    pub ego_from: f32,
    /// Upper end.
    pub ego_to: f32,
    /// Arc lengths of the other: lower end.
    pub other_from: f32,
    /// Upper end.
    pub other_to: f32,
    /// The ego's arc length minus the other's: lower end.
    pub lead_from: f32,
    /// Upper end.
    pub lead_to: f32,
    /// How they meet there.
    pub kind: cede_conflict_kind,
    /// 0.
    pub reserved: [u8; 3],
}

/// How the ego's path meets another.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct cede_conflict {
    /// Arc length in m at which the ego has reached the conflict point.
    pub ego_conflict: f32,
    /// The same for the other.
    pub other_conflict: f32,
    /// How the paths meet first, along the ego's.
    pub kind: cede_conflict_kind,
    /// Who has the right of way.
    pub right: cede_right,
    /// When it counts.
    pub priority: cede_priority,
    /// How many zones there are.
    pub zone_count: u8,
    /// The zones, in no particular order.
    pub zones: [cede_zone; CEDE_MAX_ZONES],
}

/// Begins a junction without paths, whatever was in the storage.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_init(junction: *mut cede_junction) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { make(junction, Site::begin) }.into()
}

/// Sets how far (m) any point of a vehicle's footprint may be from where it is on its path, in [0, 1]; 0.1 unless
/// it is set. cede_junction_build() checks it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_tolerance(
    junction: *mut cede_junction,
    tolerance: f32,
) -> cede_status {
    let set = |builder: &mut Builder| {
        builder.tolerance(tolerance);
        Ok(())
    };
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), core::ptr::null_mut()) }
}

/// Sets the lateral acceleration (m/s^2), at most, that the ego is to have in bends, in (0, 20]; bends do not slow it down
/// unless it is set. It bounds proposals; plans know nothing of it. cede_junction_build() checks it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_lateral(
    junction: *mut cede_junction,
    lateral: f32,
) -> cede_status {
    let set = |builder: &mut Builder| {
        builder.lateral(lateral);
        Ok(())
    };
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), core::ptr::null_mut()) }
}

/// Says that an ego on a path drives at `speed` (m/s) or slower from arc length `from` (m) on, until the next limit; up to
/// CEDE_MAX_LIMITS of them, in any order. It bounds proposals; plans know nothing of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_add_speed_limit(
    junction: *mut cede_junction,
    path: u8,
    from: f32,
    speed: f32,
    detail: *mut cede_detail,
) -> cede_status {
    let set = |builder: &mut Builder| builder.speed_limit(PathId::new(path), from, speed);
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), detail) }
}

/// Adds a path through `count` points, for vehicles of a class with this largest footprint, and writes its number. The
/// first CEDE_MAX_ENTRIES paths are those that the ego can enter by.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_add_path(
    junction: *mut cede_junction,
    points: *const cede_point,
    count: u32,
    vehicle_class: u8,
    footprint: *const cede_footprint,
    path: *mut u8,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        let result = add(junction, (points, count), vehicle_class, footprint, path);
        told(result, detail)
    }
}

unsafe fn add(
    junction: *mut cede_junction,
    (points, count): (*const cede_point, u32),
    vehicle_class: u8,
    footprint: *const cede_footprint,
    path: *mut u8,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        checked(path)?;
        let points = slice(points, count)?.iter().map(point);
        let footprint = read(footprint)?;
        let class = class(vehicle_class)?;
        let route = Route::<CEDE_MAX_ROUTE_POINTS>::new(points)?;
        let add = |builder: &mut Builder| builder.path(&route, class, of(footprint));
        number(build_up(junction, add)?, path)
    }
}

/// Adds a path along the points of path `of_path`, for another class of vehicles, and writes its number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_add_variant(
    junction: *mut cede_junction,
    of_path: u8,
    vehicle_class: u8,
    footprint: *const cede_footprint,
    path: *mut u8,
    detail: *mut cede_detail,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        let result = vary(junction, of_path, vehicle_class, footprint, path);
        told(result, detail)
    }
}

unsafe fn vary(
    junction: *mut cede_junction,
    of_path: u8,
    vehicle_class: u8,
    footprint: *const cede_footprint,
    path: *mut u8,
) -> Result<(), cede_detail> {
    // SAFETY: by the header's contract of pointers.
    unsafe {
        checked(path)?;
        let footprint = of(read(footprint)?);
        let class = class(vehicle_class)?;
        let add = |builder: &mut Builder| builder.variant(PathId::new(of_path), class, footprint);
        number(build_up(junction, add)?, path)
    }
}

unsafe fn number(id: PathId, path: *mut u8) -> Result<(), cede_detail> {
    // A path's number is at most 255.
    let number = u8::try_from(id.index()).unwrap_or(u8::MAX);
    // SAFETY: by the header's contract of pointers.
    Ok(unsafe { write(path, number) }?)
}

/// Sets where vehicles of a path wait: the arc length `s` in m of the footprint's centre. An ego that has not passed it does
/// so only with a plan that clears every zone of a crossing or a merge. Unless it is set, it is where the footprint comes to
/// the first zone in which the path crosses or merges with any other, and the ego may wait between two zones.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_line(
    junction: *mut cede_junction,
    path: u8,
    s: f32,
    detail: *mut cede_detail,
) -> cede_status {
    let set = |builder: &mut Builder| builder.line(PathId::new(path), s);
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), detail) }
}

/// Says that vehicles of path `first` go before those of path `second` if they arrive at once:
/// cede_junction_set_priority() with CEDE_PRIORITY_FIRST_COME. The last call for two paths counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_right_of_way(
    junction: *mut cede_junction,
    first: u8,
    second: u8,
    detail: *mut cede_detail,
) -> cede_status {
    let set = |builder: &mut Builder| builder.right_of_way(PathId::new(first), PathId::new(second));
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), detail) }
}

/// Says that vehicles of path `first` have the right of way over those of path `second`, and when it counts: `priority` is
/// a cede_priority. Whether the shield relies on it is for the contract to say. The last call for two paths counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_priority(
    junction: *mut cede_junction,
    first: u8,
    second: u8,
    priority: u8,
    detail: *mut cede_detail,
) -> cede_status {
    let (first, second) = (PathId::new(first), PathId::new(second));
    // SAFETY: the header's contract of pointers.
    let set = |priority| unsafe {
        build_up(junction, |builder| {
            builder.priority(first, second, priority)
        })
    };
    let result = priority_of(priority).map_err(cede_detail::from);
    // SAFETY: the header's contract of pointers.
    unsafe { told(result.and_then(set), detail) }
}

/// Says what obliges vehicles of a path to give way: `control` is a cede_control. A policy is told; the shield counts on
/// nothing of it. CEDE_CONTROL_UNKNOWN unless it is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_control(
    junction: *mut cede_junction,
    path: u8,
    control: u8,
    detail: *mut cede_detail,
) -> cede_status {
    let path = PathId::new(path);
    // SAFETY: the header's contract of pointers.
    let set = |control| unsafe { build_up(junction, |builder| builder.control(path, control)) };
    let result = control_of(control).map_err(cede_detail::from);
    // SAFETY: the header's contract of pointers.
    unsafe { told(result.and_then(set), detail) }
}

/// Sets the highest speed (m/s) of pedestrians on a path, either way, in (0, 10]; 3 unless it is set. Of other classes it says
/// nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_pace(
    junction: *mut cede_junction,
    path: u8,
    pace: f32,
    detail: *mut cede_detail,
) -> cede_status {
    let set = |builder: &mut Builder| builder.pace(PathId::new(path), pace);
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), detail) }
}

/// Sets the place of a path in the order in which vehicles at rest take turns, its number unless it is set: of two, the one with
/// the larger place has the first turns. Vehicles that are to trust each other have to agree on it (U7 of the manual).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_set_order(
    junction: *mut cede_junction,
    path: u8,
    place: u16,
    detail: *mut cede_detail,
) -> cede_status {
    let set = |builder: &mut Builder| builder.order(PathId::new(path), place);
    // SAFETY: the header's contract of pointers.
    unsafe { told(build_up(junction, set), detail) }
}

/// Builds the junction: works out how each two paths meet. Nothing can be added afterwards. A junction that is refused can
/// be mended and built again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_build(
    junction: *mut cede_junction,
    detail: *mut cede_detail,
) -> cede_status {
    let build = |site: &mut Site| -> Result<(), cede_detail> {
        let built = core::ptr::from_ref(site.unfinished()?.build_in_place()?);
        site.built = built;
        Ok(())
    };
    // SAFETY: the header's contract of pointers.
    unsafe {
        let result = change(junction, build).map_err(cede_detail::from);
        told(result.flatten(), detail)
    }
}

/// Checks the junction's checksum: a test for the background, to find memory that has changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_check(junction: *const cede_junction) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { ask(junction, |_| Ok(())) }.into()
}

/// Writes the number of paths.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_count(
    junction: *const cede_junction,
    paths: *mut u32,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe { ask(junction, |built| write(paths, built.paths().len() as u32)) }.into()
}

/// Describes a path of a junction that is built.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_path(
    junction: *const cede_junction,
    path: u8,
    info: *mut cede_path_info,
) -> cede_status {
    let path = PathId::new(path);
    // SAFETY: the header's contract of pointers.
    unsafe {
        ask(junction, |built| {
            let there = built.path(path).zip(built.polyline(path));
            let (path, line) = there.ok_or(cede_status::JunctionUnknownPath)?;
            write(info, described(path, line.length()))
        })
    }
    .into()
}

/// The pose at arc length `s` (m) of a path; before its start and past its end a path goes on straight.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_pose(
    junction: *const cede_junction,
    path: u8,
    s: f32,
    result: *mut cede_pose,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        ask(junction, |built| {
            let line = built.polyline(PathId::new(path));
            let line = line.ok_or(cede_status::JunctionUnknownPath)?;
            write(result, pose(&line.pose(s)))
        })
    }
    .into()
}

/// The arc length (m) of the point of a path that is nearest to `position`: from localisation to `s`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_project(
    junction: *const cede_junction,
    path: u8,
    position: *const cede_point,
    s: *mut f32,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        ask(junction, |built| {
            let line = built.polyline(PathId::new(path));
            let line = line.ok_or(cede_status::JunctionUnknownPath)?;
            write(s, line.project(point(&read(position)?)))
        })
    }
    .into()
}

/// How path `ego`, one that can be entered, meets path `other`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cede_junction_conflict(
    junction: *const cede_junction,
    ego: u8,
    other: u8,
    conflict: *mut cede_conflict,
) -> cede_status {
    // SAFETY: the header's contract of pointers.
    unsafe {
        ask(junction, |built| {
            let there = built.conflict(PathId::new(ego), PathId::new(other));
            let there = there.ok_or(cede_status::JunctionUnknownPath)?;
            write(conflict, there.into())
        })
    }
    .into()
}

/// What `work` gives on a junction that is built.
unsafe fn ask<R>(
    junction: *const cede_junction,
    work: impl FnOnce(&Built) -> Result<R, cede_status>,
) -> Result<R, cede_status> {
    // SAFETY: by the header's contract of pointers, nobody changes it during the call.
    unsafe { work(lend(junction)?.built()?) }
}

/// What `work` gives on a junction that is not built yet.
unsafe fn build_up<R>(
    junction: *mut cede_junction,
    work: impl FnOnce(&mut Builder) -> Result<R, JunctionError>,
) -> Result<R, cede_detail> {
    // SAFETY: by the header's contract of pointers.
    let result = unsafe { change(junction, |site| Ok(work(site.unfinished()?)?)) };
    result?
}

fn of(footprint: cede_footprint) -> Footprint {
    Footprint {
        length: footprint.length,
        width: footprint.width,
    }
}

fn described(path: &Path, length: f32) -> cede_path_info {
    let Footprint {
        length: long,
        width,
    } = path.footprint();
    cede_path_info {
        length,
        line: path.line(),
        footprint: cede_footprint {
            length: long,
            width,
        },
        vehicle_class: class_number(path.class()),
        control: match path.control() {
            Control::Unknown => cede_control::Unknown,
            Control::Free => cede_control::Free,
            Control::Yield => cede_control::Yield,
            Control::Stop => cede_control::Stop,
            Control::AllWayStop => cede_control::AllWayStop,
        },
        waits_at_line: path.waits_at_line().into(),
        reserved: 0,
    }
}

fn priority_of(number: u8) -> Result<Priority, cede_status> {
    const FIRST_COME: u8 = cede_priority::FirstCome as u8;
    const UNSIGNED: u8 = cede_priority::Unsigned as u8;
    const SIGNED: u8 = cede_priority::Signed as u8;
    match number {
        FIRST_COME => Ok(Priority::FirstCome),
        UNSIGNED => Ok(Priority::Unsigned),
        SIGNED => Ok(Priority::Signed),
        _ => Err(cede_status::UnknownChoice),
    }
}

fn control_of(number: u8) -> Result<Control, cede_status> {
    // In the order of cede_control.
    let known = Control::ALL.get(usize::from(number));
    known.copied().ok_or(cede_status::UnknownChoice)
}

impl From<&RouteConflict> for cede_conflict {
    fn from(conflict: &RouteConflict) -> Self {
        let mut zones = [cede_zone::NONE; CEDE_MAX_ZONES];
        for (place, zone) in zones.iter_mut().zip(conflict.zones()) {
            *place = zone.into();
        }
        Self {
            ego_conflict: conflict.ego_conflict,
            other_conflict: conflict.other_conflict,
            kind: kind(conflict.kind),
            right: match conflict.right_of_way {
                RightOfWay::Unsettled => cede_right::Unsettled,
                RightOfWay::Ego => cede_right::Ego,
                RightOfWay::Other => cede_right::Other,
            },
            priority: match conflict.priority {
                Priority::FirstCome => cede_priority::FirstCome,
                Priority::Unsigned => cede_priority::Unsigned,
                Priority::Signed => cede_priority::Signed,
            },
            zone_count: conflict.zones().count() as u8,
            zones,
        }
    }
}

impl cede_zone {
    const NONE: Self = Self {
        ego_from: 0.0,
        ego_to: 0.0,
        other_from: 0.0,
        other_to: 0.0,
        lead_from: 0.0,
        lead_to: 0.0,
        kind: cede_conflict_kind::None,
        reserved: [0; 3],
    };
}

impl From<&Zone> for cede_zone {
    fn from(zone: &Zone) -> Self {
        Self {
            ego_from: zone.ego.from,
            ego_to: zone.ego.to,
            other_from: zone.other.from,
            other_to: zone.other.to,
            lead_from: zone.lead.from,
            lead_to: zone.lead.to,
            kind: kind(zone.kind),
            reserved: [0; 3],
        }
    }
}

fn kind(kind: ConflictKind) -> cede_conflict_kind {
    match kind {
        ConflictKind::None => cede_conflict_kind::None,
        ConflictKind::Crossing => cede_conflict_kind::Crossing,
        ConflictKind::Merging => cede_conflict_kind::Merging,
        ConflictKind::Following => cede_conflict_kind::Following,
    }
}

impl From<RouteError> for cede_detail {
    fn from(error: RouteError) -> Self {
        Self::new(match error {
            RouteError::TooFewPoints => cede_status::RouteTooFewPoints,
            RouteError::TooManyPoints => cede_status::RouteTooManyPoints,
            RouteError::OutOfRange => cede_status::RouteOutOfRange,
            _ => cede_status::Other,
        })
    }
}

impl From<JunctionError> for cede_detail {
    fn from(error: JunctionError) -> Self {
        use JunctionError as Error;
        let about = |status, path: PathId, value, high| Self {
            path: u8::try_from(path.index()).unwrap_or(u8::MAX),
            value,
            high,
            ..Self::new(status)
        };
        match error {
            Error::NoPaths => cede_status::JunctionNoPaths.into(),
            Error::TooManyPaths { capacity } => Self {
                high: capacity as f32,
                ..Self::new(cede_status::JunctionTooManyPaths)
            },
            Error::TooManyPoints {
                path,
                points,
                capacity,
            } => about(
                cede_status::JunctionTooManyPoints,
                path,
                points as f32,
                capacity as f32,
            ),
            Error::UnknownPath { path, paths } => Self {
                index: paths as u32,
                ..about(cede_status::JunctionUnknownPath, path, 0.0, 0.0)
            },
            Error::Footprint {
                path,
                length,
                width,
            } => {
                let high = cede_controller::junction::MAX_FOOTPRINT;
                let bad = |side: f32| !(side > 0.0 && side <= high);
                let value = if bad(length) { length } else { width };
                Self {
                    excludes_low: 1,
                    ..about(cede_status::JunctionFootprint, path, value, high)
                }
            }
            Error::Tolerance { value } => Self {
                value,
                high: cede_controller::junction::MAX_TOLERANCE,
                ..Self::new(cede_status::JunctionTolerance)
            },
            Error::Kink { path, at, degrees } => Self {
                index: at as u32,
                ..about(cede_status::JunctionKink, path, degrees, 90.0)
            },
            Error::TooLong { path, length } => about(
                cede_status::JunctionTooLong,
                path,
                length,
                cede_controller::junction::MAX_PATH_LENGTH,
            ),
            Error::Returns { path } => about(cede_status::JunctionReturns, path, 0.0, 0.0),
            Error::Line {
                path,
                value,
                length,
            } => about(cede_status::JunctionLine, path, value, length),
            Error::SpeedLimit {
                path,
                from,
                speed,
                length,
            } => {
                let high = cede_controller::junction::MAX_SPEED_LIMIT;
                if speed > 0.0 && speed <= high {
                    about(cede_status::JunctionSpeedLimit, path, from, length)
                } else {
                    Self {
                        excludes_low: 1,
                        ..about(cede_status::JunctionSpeedLimit, path, speed, high)
                    }
                }
            }
            Error::TooManyLimits { path } => {
                let capacity = CEDE_MAX_LIMITS as f32;
                about(cede_status::JunctionTooManyLimits, path, 0.0, capacity)
            }
            Error::Pace { path, value } => Self {
                excludes_low: 1,
                ..about(
                    cede_status::JunctionPace,
                    path,
                    value,
                    cede_controller::junction::MAX_PACE,
                )
            },
            Error::Lateral { value } => Self {
                value,
                high: cede_controller::junction::MAX_LATERAL,
                excludes_low: 1,
                ..Self::new(cede_status::JunctionLateral)
            },
            Error::RightOfWay { path } => about(cede_status::JunctionRightOfWay, path, 0.0, 0.0),
            _ => cede_status::Other.into(),
        }
    }
}

pub(crate) const CONFLICT: &[(u8, &CStr)] = &[
    (cede_conflict_kind::None as u8, c"none"),
    (cede_conflict_kind::Crossing as u8, c"crossing"),
    (cede_conflict_kind::Merging as u8, c"merging"),
    (cede_conflict_kind::Following as u8, c"following"),
];

pub(crate) const RIGHT: &[(u8, &CStr)] = &[
    (cede_right::Unsettled as u8, c"unsettled"),
    (cede_right::Ego as u8, c"the ego"),
    (cede_right::Other as u8, c"the other"),
];

pub(crate) const PRIORITY: &[(u8, &CStr)] = &[
    (cede_priority::FirstCome as u8, c"who comes first"),
    (cede_priority::Unsigned as u8, c"without signs"),
    (cede_priority::Signed as u8, c"by signs"),
];

pub(crate) const CONTROL: &[(u8, &CStr)] = &[
    (cede_control::Unknown as u8, c"not known"),
    (cede_control::Free as u8, c"free"),
    (cede_control::Yield as u8, c"yield"),
    (cede_control::Stop as u8, c"stop"),
    (cede_control::AllWayStop as u8, c"all-way stop"),
];

pub(crate) const CLASS: &[(u8, &CStr)] = &[
    (CEDE_CLASS_CAR, c"car"),
    (CEDE_CLASS_LORRY, c"lorry"),
    (CEDE_CLASS_BICYCLE, c"bicycle"),
    (CEDE_CLASS_PEDESTRIAN, c"pedestrian"),
];
