//! A scene made ready to render: tables, geometry, lights and camera in single precision around a local
//! origin, and the decision which kernel runs.

mod boundaries;
mod crossing;
mod extent;
mod gains;
mod locate;
mod medium;
mod needs;
mod queue;
mod shape;
mod storage;
mod work;

pub use boundaries::{Boundaries, Sides};
pub(crate) use medium::PacketSource;
pub use medium::{
    Beyond, BrickTables, CloudDensity, CloudField, Details, Emission, EmissiveVoxel, Field, Held,
    Local, Medium, PhaseFunction, Support, Tables, held,
};
pub use needs::{Decision, Feature, Need, Needs};
pub use work::LIMIT as COLLISION_LIMIT;

use glam::{DAffine3, DVec3};
use woodcock_core::camera::{self, Camera};
use woodcock_core::light::{Distant, Lights};
use woodcock_core::path::{Convex, Enclosure as SurfaceBox, RECORD_WORDS, RecordKind, Settings};
use woodcock_core::ray::{FAR, Ray as CoreRay};
use woodcock_core::vec3::Vec3;

use crate::bsdf::Materials;
use crate::integrator::Stretch;
use crate::integrator::glow::Glow;
use crate::integrator::room::Blueprint;
use crate::light::Lights as Lighting;
use crate::ray::Ray;
use crate::surface::Surfaces;

use crate::film::Window;
use crate::scene::{
    Enclosure, Files, Light, MediumId, MediumKind, Projection, Scene, SceneError, Warning,
};
use crate::volume::Limits;
use locate::locate;
use medium::Surroundings;
pub(crate) use queue::Plane;
use queue::{ENCLOSURES, planes, queued};

/// Where media lie.
#[derive(Debug)]
pub enum Location {
    /// Nowhere: every ray meets only the environment.
    Nowhere,
    /// One medium in a convex shape.
    Convex(Convex),
    /// Any media within any surfaces.
    Boundaries(Boundaries),
}

/// A scene, assembled.
#[derive(Debug)]
pub struct World {
    /// Size of the whole picture.
    pub resolution: [u32; 2],
    /// The part of it to render.
    pub window: Window,
    /// Camera rays.
    pub camera: Camera,
    /// Lights in one direction.
    pub distant: Vec<Distant>,
    /// Radiance of the constant environment.
    pub environment: [f32; 3],
    /// All media that can be seen.
    pub media: Vec<Medium>,
    /// Their grids.
    pub tables: Tables,
    /// The media's records as words, for kernels of several media.
    pub records: Vec<u32>,
    /// Where they lie.
    pub place: Location,
    /// What runs and what is skipped.
    pub needs: Needs,
    /// Scatterings after which the scene cuts paths off.
    pub max_depth: Option<u32>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Surfaces with matter or light.
    pub surfaces: Surfaces,
    /// What they are made of.
    pub materials: Materials,
    /// All lights but media, as scalar integrators sample them.
    pub lighting: Lighting,
    /// The light of the only medium, for packets.
    pub(crate) source: Option<PacketSource>,
    /// Media that shine, as lights.
    pub(crate) glow: Option<Glow>,
    /// The tables of a scene that is a room.
    pub(crate) room: Option<Blueprint>,
    /// Boxes around all surfaces, for packets that have to know where none are.
    pub(crate) enclosures: Vec<SurfaceBox>,
    /// Those of them that are flat.
    pub(crate) planes: Vec<Plane>,
    /// The largest extinction of each medium, by its bounds [1/length].
    pub(crate) thickest: Vec<f64>,
    /// The diameter of what bounds the media \[length\]; infinite where one fills space.
    extent: f64,
    /// The camera may be inside one.
    camera_within: bool,
}

/// Choices of the user that shape the assembly.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Features to keep though the scene does not need them.
    pub keep: Vec<Feature>,
    /// Picture size in place of the scene's.
    pub resolution: Option<[u32; 2]>,
    /// Part of the picture in place of the scene's, in fractions of it.
    pub crop: Option<[f64; 4]>,
    /// Memory.
    pub limits: Limits,
}

impl World {
    /// Whether the kernels of packets can render it.
    pub fn is_plain(&self) -> bool {
        self.needs.in_packets()
    }

    /// Probability with which light sampling chooses media that shine.
    pub(crate) fn glow_choice(&self) -> f64 {
        self.glow.as_ref().map_or(0.0, Glow::choice)
    }

    /// The stretches of a ray within media up to `t_max`, sorted by where they begin.
    pub(crate) fn stretches(&self, ray: &Ray, t_max: f64, found: &mut Vec<Stretch>) {
        found.clear();
        match &self.place {
            Location::Nowhere => {}
            Location::Convex(convex) => {
                let vec3 = |v: DVec3| Vec3::new(v.x, v.y, v.z);
                let interval = convex.clip(&CoreRay::<f64> {
                    origin: vec3(ray.origin),
                    direction: vec3(ray.direction),
                });
                found.push((interval.t0, interval.t1, 0));
            }
            Location::Boundaries(boundaries) => {
                boundaries.stretches(ray.origin, ray.direction, found);
            }
        }
        for stretch in &mut *found {
            stretch.1 = stretch.1.min(t_max).min(f64::from(FAR));
        }
        found.retain(|stretch| stretch.0 < stretch.1);
    }

    /// Whether a place lies within a medium.
    pub(crate) fn is_within(&self, medium: usize, place: DVec3) -> bool {
        let mut found = Vec::new();
        let ray = Ray {
            origin: place,
            direction: DVec3::X,
        };
        self.stretches(&ray, f64::INFINITY, &mut found);
        found.iter().any(|s| s.2 == medium && s.0 <= 0.0)
    }

    /// How packets trace paths; the depth is for the user to limit.
    pub(crate) fn settings(&self) -> Settings {
        let forced = !self.needs.runs(Feature::FreePassage) && self.needs.runs(Feature::Scattering);
        let all = Settings::default();
        Settings {
            points: !self.needs.runs(Feature::IndependentSamples),
            forced,
            combed: self.source.is_some() && !self.needs.runs(Feature::FlownEmission),
            faint: if self.needs.runs(Feature::FaintShadowRays) {
                Settings::ALL_SHADOW_RAYS
            } else {
                faint(&self.media)
            },
            bright: if self.needs.runs(Feature::SingleEstimates) {
                f32::INFINITY
            } else {
                bright(&self.media)
            },
            ..all
        }
    }

    /// The lights as kernels see them.
    pub fn lights(&self) -> Lights<'_> {
        Lights {
            distant: &self.distant,
            environment: self.environment,
            sample_environment: self.needs.runs(Feature::EnvironmentNextEvent),
        }
    }

    /// About how often a path collides on average, if nothing cuts it off; see [`COLLISION_LIMIT`].
    pub fn collisions_expected(&self) -> f64 {
        let of = |m| work::collisions(m, &self.tables, self.extent, self.camera_within);
        self.media.iter().map(of).fold(0.0, f64::max)
    }

    /// Whether a medium without bounds scatters some colour without ever absorbing it, so that a path in it ends
    /// only where it is cut off.
    pub fn is_endless(&self) -> bool {
        let medium = exterior(&self.place).and_then(|index| self.media.get(index));
        medium.is_some_and(|m| {
            let record = &m.record;
            m.support.is_none() && (0..3).any(|c| record.albedo[c] == 1.0 && record.colour[c] > 0.0)
        })
    }
}

/// The medium that fills what nothing else does.
fn exterior(place: &Location) -> Option<usize> {
    match place {
        Location::Convex(Convex::Everywhere) => Some(0),
        Location::Boundaries(boundaries) => boundaries.exterior(),
        _ => None,
    }
}

/// The media of a scene as assembled: their index, or nothing where a medium cannot be seen.
struct Assembled {
    media: Vec<Medium>,
    index: Vec<Option<usize>>,
    tables: Tables,
}

impl Assembled {
    fn of(&self, id: Option<MediumId>) -> Option<usize> {
        self.index.get(id?.0).copied().flatten()
    }
}

/// Makes a scene ready to render.
///
/// # Errors
/// A volume that cannot be read or rendered, at its medium's place in the scene; a picture that exceeds the
/// memory limit; what this version cannot do.
pub fn assemble(scene: &Scene, files: &dyn Files, options: &Options) -> Result<World, SceneError> {
    let (resolution, window) = picture(scene, options)?;
    let mut warnings = Vec::new();
    let origin = local_origin(scene);
    let mut assembled = assemble_media(scene, origin, files, options, &mut warnings)?;
    let keep = &options.keep;
    let mut needs = Needs::default();

    let grids = assembled
        .media
        .iter()
        .filter(|m| m.support.is_some())
        .count();
    let total = assembled.media.len();
    needs.decide(
        Feature::Tracking,
        grids > 0,
        keep,
        match (total, grids) {
            (0, _) => "no medium to be seen".to_owned(),
            (_, 0) => "homogeneous media only: closed form".to_owned(),
            _ => format!("{grids} of {total} media on grids"),
        },
    );
    let chromatic_media = assembled.media.iter().filter(|m| m.is_chromatic()).count();
    needs.decide(
        Feature::Chromatic,
        chromatic_media > 0,
        keep,
        if chromatic_media > 0 {
            format!("extinction differs between colours in {chromatic_media} of {total} media")
        } else {
            "grey extinction: one scalar weight".to_owned()
        },
    );
    let place = locate(scene, &assembled, origin, keep, &mut needs, &mut warnings);
    lights_needed(scene, keep, &mut needs);
    let rayleigh = assembled.media.iter().any(|m| m.record.rayleigh);
    let reason = if rayleigh {
        "a medium scatters so"
    } else {
        "no medium scatters so"
    };
    needs.decide(Feature::Rayleigh, rayleigh, keep, reason);
    let lens = scene.camera.lens_radius > 0.0;
    let reason = if lens {
        "a lens of finite size"
    } else {
        "a pinhole"
    };
    needs.decide(Feature::Lens, lens, keep, reason);

    let surfaces = Surfaces::new(scene, origin)?;
    let materials = Materials::new(&scene.materials, files, &options.limits)?;
    let bounds = extent::bounds(scene, &surfaces, &assembled.media, origin);
    let lighting = Lighting::new(scene, &surfaces, bounds, origin, files, &options.limits)?;
    let alone = lighting.is_empty();
    let glow = Glow::new(&assembled.media, &assembled.tables, alone);
    let source = match assembled.media.as_slice() {
        [medium] => medium.packet_source(),
        _ => None,
    };
    let overlaps = matches!(&place, Location::Boundaries(b) if b.overlap());
    scalar_needed(
        scene,
        (&assembled.media, overlaps, source.is_some()),
        &surfaces,
        keep,
        &mut needs,
    );
    let matter = (assembled.media.as_slice(), &surfaces);
    let room = room(scene, origin, matter, &place, keep, &mut needs);
    let enclosures = surfaces.enclosures(ENCLOSURES);
    let planes = planes(&enclosures);
    let single = |corner: DVec3| corner.as_vec3().to_array();
    let enclosures = enclosures.into_iter().map(|[low, high]| SurfaceBox {
        low: single(low),
        high: single(high),
    });
    let enclosures = enclosures.collect();
    // Of grids, which have extents of their own, seen from outside; no other medium shines in packets.
    let collisions = assembled
        .media
        .iter()
        .map(|m| work::collisions(m, &assembled.tables, f64::INFINITY, false))
        .fold(0.0, f64::max);
    let media = (assembled.media.as_slice(), collisions);
    path_needed(scene, media, &place, keep, &mut needs);
    storage::store(&assembled.media, &mut assembled.tables, keep, &mut needs);
    let (distant, environment) = lights(scene)?;
    let records = assembled
        .media
        .iter()
        .flat_map(|m| m.record.to_words())
        .collect::<Vec<_>>();
    debug_assert_eq!(records.len(), assembled.media.len() * RECORD_WORDS);
    let extent = if exterior(&place).is_some() {
        f64::INFINITY
    } else {
        extent::diameter(scene)
    };
    let thickest = |medium| work::thickest(medium, &assembled.tables);
    Ok(World {
        thickest: assembled.media.iter().map(thickest).collect(),
        extent,
        camera_within: scene.camera_medium.is_some(),
        resolution,
        window,
        camera: camera(scene, resolution, origin),
        distant,
        environment,
        media: assembled.media,
        tables: assembled.tables,
        records,
        place,
        needs,
        max_depth: scene.integrator.max_depth,
        warnings,
        surfaces,
        materials,
        lighting,
        source,
        glow,
        room,
        enclosures,
        planes,
    })
}

/// The tables of a scene that is a room, and the row that says whether it is one.
fn room(
    scene: &Scene,
    origin: DVec3,
    (media, surfaces): (&[Medium], &Surfaces),
    place: &Location,
    keep: &[Feature],
    needs: &mut Needs,
) -> Option<Blueprint> {
    if scene.surfaces.is_empty() && scene.instances.is_empty() {
        let kept = needs.runs(Feature::Surfaces);
        needs.decide(Feature::DetailedSurfaces, kept, keep, "no surfaces");
        needs.decide(Feature::SurfaceQueue, false, &[], "no surfaces");
        return None;
    }
    let room = Blueprint::new(scene, origin, media, place);
    let queue = queued(media, surfaces, needs);
    let reason = match (&room, &queue) {
        (Ok(room), _) => room.summary(),
        (Err(refusal), Ok(())) => format!("no room ({refusal}), but packets track the media"),
        (Err(refusal), Err(other)) => format!("{refusal}; {other}"),
    };
    let needed = room.is_err() && queue.is_err();
    let detailed = needs.decide(Feature::DetailedSurfaces, needed, keep, reason);
    let queues = room.is_err() && !detailed && needs.runs(Feature::Surfaces);
    let reason = match (&room, queues) {
        (Ok(_), _) => "rays of a room meet surfaces in lanes",
        (_, true) => "media are tracked in packets, hits on surfaces wait in a queue",
        (_, false) => "the scalar integrators",
    };
    needs.decide(Feature::SurfaceQueue, queues, &[], reason);
    room.ok()
}

/// What only scalar integrators do.
fn scalar_needed(
    scene: &Scene,
    (media, overlaps, lit_in_packets): (&[Medium], bool, bool),
    surfaces: &Surfaces,
    keep: &[Feature],
    needs: &mut Needs,
) {
    let (shapes, shining) = (scene.surfaces.len(), surfaces.emitters());
    let reason = match (surfaces.is_empty(), shining) {
        (true, _) => "nothing but media".to_owned(),
        (_, 0) => format!("{shapes} surfaces and {} instances", scene.instances.len()),
        _ => format!("{shapes} surfaces, {shining} pieces of which shine"),
    };
    needs.decide(Feature::Surfaces, !surfaces.is_empty(), keep, reason);
    let is_local = |light: &&Light| match light {
        Light::Distant(_) | Light::Constant(_) => false,
        Light::Image(_) | Light::Point(_) | Light::Spot(_) | Light::Goniometric(_) => true,
    };
    let local = scene.lights.iter().filter(is_local).count();
    let reason = match local {
        0 => "no lights but suns and constant skies".to_owned(),
        n => format!("{n} lights at points or with pictures"),
    };
    needs.decide(Feature::LocalLights, local > 0, &[], reason);
    let glowing = media.iter().filter(|medium| medium.is_emissive()).count();
    let reason = match glowing {
        0 => "no medium shines".to_owned(),
        n => format!("{n} media shine"),
    };
    needs.decide(Feature::Emission, glowing > 0, &[], reason);
    let beyond_packets = |medium: &&Medium| !medium.is_plain() && !lit_in_packets;
    let detailed = media.iter().filter(beyond_packets).count();
    let mixed = overlaps && needs.runs(Feature::Chromatic);
    let reason = match (detailed, mixed) {
        (0, false) => "media are grey or of one colour throughout".to_owned(),
        (0, true) => "coloured media overlap".to_owned(),
        (n, _) => format!("{n} media shine, vary in colour or scatter by other laws"),
    };
    needs.decide(Feature::DetailedMedia, detailed > 0 || mixed, &[], reason);
    let at_points = scene
        .lights
        .iter()
        .any(|light| is_local(&light) && !matches!(light, Light::Image(_)));
    let near = (at_points || shining > 0) && !media.is_empty();
    let reason = match (near, overlaps) {
        (false, _) => "no light is near a medium",
        (true, false) => "lights among media: distances are sampled by nearness too",
        (true, true) => "media overlap: flights alone find distances",
    };
    // Where media overlap, a place does not tell which of them scatters.
    let keep = if overlaps { &[] } else { keep };
    needs.decide(Feature::EquiAngular, near && !overlaps, keep, reason);
}

/// What the paths of packets may leave out.
fn path_needed(
    scene: &Scene,
    (media, collisions): (&[Medium], f64),
    place: &Location,
    keep: &[Feature],
    needs: &mut Needs,
) {
    if !needs.in_packets() {
        let apart = needs.runs(Feature::DetailedSurfaces) || !needs.runs(Feature::Surfaces);
        let reason = if apart {
            "the scalar integrators"
        } else {
            "a room's paths"
        };
        for feature in [
            Feature::Scattering,
            Feature::FreePassage,
            Feature::FaintShadowRays,
            Feature::SingleEstimates,
            Feature::SharedPaths,
        ] {
            needs.decide(feature, true, keep, reason);
        }
        let shines = needs.runs(Feature::Emission);
        needs.decide(Feature::FlownEmission, shines, keep, reason);
        let reason = if apart { reason } else { SHARED };
        needs.decide(Feature::IndependentSamples, apart, keep, reason);
        return;
    }
    let among_surfaces = needs.runs(Feature::SurfaceQueue);
    let scatters = media.iter().any(|m| m.record.albedo != [0.0; 3]);
    let shines = needs.runs(Feature::Emission);
    let reason = match (scatters, shines, media.is_empty()) {
        _ if among_surfaces => "surfaces scatter",
        (true, ..) => "a medium scatters",
        (false, true, _) => "a medium shines on the way to where flights end",
        (false, false, false) => "absorption only: transmittance alone",
        (false, false, true) => "no medium to be seen",
    };
    let scatters = scatters || shines || among_surfaces;
    let scatters = needs.decide(Feature::Scattering, scatters, keep, reason);
    let one = matches!(place, Location::Convex(convex) if *convex != Convex::Everywhere)
        && !needs.runs(Feature::Tracking)
        && !needs.runs(Feature::SeveralMedia)
        && !among_surfaces;
    let spread = spread(media);
    let alike = spread < COLOURS_APART;
    let reason = match (needs.runs(Feature::Chromatic), alike) {
        (false, _) => "extinction is grey: nothing to share".to_owned(),
        (true, true) => {
            format!("extinction differs between colours by a factor of {spread:.2} only")
        }
        (true, false) => {
            format!(
                "extinction differs {spread:.1}-fold between colours: each has grey paths of its own"
            )
        }
    };
    let chromatic = needs.runs(Feature::Chromatic);
    let shared = needs.decide(Feature::SharedPaths, chromatic && alike, keep, reason);
    let grey = !(chromatic && shared);
    let escapes = !needs.runs(Feature::EnvironmentNextEvent);
    let reason = match (scatters, one, grey, escapes) {
        (false, ..) => "no flight to end",
        (true, true, true, true) => {
            "one homogeneous grey medium: flights that matter collide, what would pass is scored"
        }
        (true, true, true, false) => "the sky is sampled as well",
        (true, true, false, _) => "extinction differs between colours",
        (true, false, ..) => "no closed form for what passes",
    };
    let passage = scatters && !(one && grey && escapes);
    needs.decide(Feature::FreePassage, passage, keep, reason);
    let overlaps = matches!(place, Location::Boundaries(b) if b.overlap());
    let often = collisions > COMBED;
    let reason = match (shines, grey, overlaps, often) {
        (false, ..) => "no medium shines",
        (true, false, ..) => "paths carry all colours",
        (true, true, true, _) => "media overlap",
        (true, true, false, true) => "light scatters so often that camera rays see little else",
        (true, true, false, false) => "combs of points find what camera rays see of what shines",
    };
    let flown = shines && (!grey || overlaps || often);
    needs.decide(Feature::FlownEmission, flown, keep, reason);
    let [reason, single] = if !scatters || scene.lights.is_empty() {
        ["no shadow ray".to_owned(), "no shadow ray".to_owned()]
    } else {
        let (faint, bright) = (faint(media), bright(media));
        [
            format!("one that scattering favours less than {faint:.3}/sr is traced by chance only"),
            if needs.runs(Feature::Tracking) {
                format!(
                    "ratio tracking, repeated for every {bright:.3}/sr by which scattering favours a ray"
                )
            } else {
                "closed forms".to_owned()
            },
        ]
    };
    needs.decide(Feature::FaintShadowRays, false, keep, reason);
    needs.decide(Feature::SingleEstimates, false, keep, single);
    needs.decide(Feature::IndependentSamples, false, keep, SHARED);
}

/// Collisions of a path up to which combs of points along camera rays are worth their time: scattering brings the rest. On fires that
/// collide 1, 6 and 26 times before they are absorbed they gained a factor of 5.2, 1.25 and 0.8; on a thin one that scatters 15 times
/// at most, 2.2.
const COMBED: f64 = 16.0;

/// Why samples need not be independent.
const SHARED: &str = "sixteen samples of a pixel share out their first choices";

/// Colours whose extinctions differ by this factor or more have paths of their own. One path for all carries weights
/// that drift apart with each collision until it serves one colour, at the cost of the most opaque.
const COLOURS_APART: f64 = 1.33;

/// The largest over the smallest extinction of a medium's colours, of the medium where they differ most; infinite
/// where one has none.
fn spread(media: &[Medium]) -> f64 {
    let of = |medium: &Medium| {
        let least = medium.record.colour.into_iter().fold(1.0, f32::min);
        1.0 / f64::from(least)
    };
    media.iter().map(of).fold(1.0, f64::max)
}

/// The density of scattering [1/sr] below which shadow rays are faint: a share of the root mean square of that of the
/// most even medium.
///
/// A shadow ray costs about the same whatever it brings, so it should be traced with a probability in proportion to
/// that, and what is usual in the scene is worth its cost. The share was found on clouds with g = 0 and g = 0.85.
pub(crate) fn faint(media: &[Medium]) -> f32 {
    const SHARE: f64 = 0.7;
    const UNIFORM: f64 = 0.25 / std::f64::consts::PI;
    let scattering = media.iter().filter(|m| m.record.albedo != [0.0; 3]);
    let rms = scattering.map(|medium| {
        let g = f64::from(medium.record.g);
        if medium.record.rayleigh {
            UNIFORM * (2.1_f64 * 8.0 / 15.0).sqrt()
        } else {
            UNIFORM * (1.0 + g * g).sqrt() / (1.0 - g * g)
        }
    });
    let least = rms.fold(f64::INFINITY, f64::min);
    if least.is_finite() {
        (SHARE * least) as f32
    } else {
        Settings::default().faint
    }
}

/// The density of scattering [1/sr] for each multiple of which a shadow ray is estimated once more.
///
/// A ray's noise weighs by the square of what it brings, so estimates are best shared out in proportion to that. What follows
/// from [`faint`] is the proportion; the factor was found on the `cloud` of the benches: 1, 2 and 4 gain 1.08, 1.15 and 1.13.
fn bright(media: &[Medium]) -> f32 {
    let estimated = |m: &Medium| matches!(m.record.kind, RecordKind::Grid { .. });
    if media.iter().any(estimated) {
        2.0 * faint(media)
    } else {
        f32::INFINITY // all that passes has a closed form
    }
}

/// Size of the picture, and the part of it to render.
fn picture(scene: &Scene, options: &Options) -> Result<([u32; 2], Window), SceneError> {
    let film = &scene.film;
    let resolution = options.resolution.unwrap_or([film.width, film.height]);
    let error = |message: String| match &film.place {
        Some(place) => SceneError::at(place, message),
        None => SceneError::of_file("the picture", message),
    };
    let window = match options.crop {
        Some(crop) => Window::crop(resolution, crop),
        None if options.resolution.is_some() => {
            // In integers: a third of 300 pixels is 100, and not 100.000003 rounded up.
            let edge = |at: u32, of: u32, size: u32| {
                let scaled = u64::from(at) * u64::from(size);
                u32::try_from(scaled.div_ceil(u64::from(of).max(1))).unwrap_or(size)
            };
            let c = &film.crop;
            let [width, height] = resolution;
            Window {
                x0: edge(c.x0, film.width, width),
                y0: edge(c.y0, film.height, height),
                x1: edge(c.x1, film.width, width),
                y1: edge(c.y1, film.height, height),
            }
        }
        None => {
            let c = &film.crop;
            Window {
                x0: c.x0,
                y0: c.y0,
                x1: c.x1,
                y1: c.y1,
            }
        }
    };
    if window.is_empty() {
        return Err(error("the crop window holds no pixel".into()));
    }
    let needed = window
        .pixels()
        .saturating_mul(crate::film::Film::BYTES_PER_PIXEL);
    let limit = options.limits.max_memory;
    if needed > limit {
        return Err(error(format!(
            "a picture of {} pixels needs {needed} bytes, the limit is {limit}; raise --max-memory or lower the resolution",
            window.pixels()
        )));
    }
    let [width, height] = resolution.map(u64::from);
    if width * height > u64::from(u32::MAX) {
        return Err(error("a picture has at most 2^32 pixels".into()));
    }
    Ok((resolution, window))
}

/// The place that single precision is finest about: the middle of the boundaries, or of the first grid, or
/// the camera.
fn local_origin(scene: &Scene) -> DVec3 {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    let mut add = |p: DVec3| {
        low = low.min(p);
        high = high.max(p);
    };
    for boundary in &scene.boundaries {
        match &boundary.shape {
            Enclosure::Sphere(sphere) => add(sphere.object_to_world.translation),
            Enclosure::TriangleMesh(mesh) => mesh.positions.iter().copied().for_each(&mut add),
        }
    }
    if low.is_finite() {
        return (low + high) * 0.5;
    }
    let grid = scene
        .media
        .iter()
        .find(|m| !matches!(m.kind, MediumKind::Homogeneous));
    grid.map_or(scene.camera.camera_to_world.translation, |m| {
        m.medium_to_world.translation
    })
}

fn assemble_media(
    scene: &Scene,
    origin: DVec3,
    files: &dyn Files,
    options: &Options,
    warnings: &mut Vec<Warning>,
) -> Result<Assembled, SceneError> {
    let used = |id: usize| {
        let id = Some(MediumId(id));
        scene.camera_medium == id
            || scene
                .boundaries
                .iter()
                .any(|b| b.inside == id || b.outside == id)
    };
    let in_one_table = |kept: &Feature| matches!(kept, Feature::DenseGrid | Feature::SeveralMedia);
    let alone = !options.keep.iter().any(in_one_table)
        && (0..scene.media.len()).filter(|id| used(*id)).count() == 1;
    let around = Surroundings {
        origin,
        exposure: scene.film.imaging_ratio,
        files,
        limits: &options.limits,
        bricks_from: alone.then_some(if options.keep.contains(&Feature::Bricks) {
            0
        } else {
            medium::BRICKS_FROM
        }),
    };
    let mut assembled = Assembled {
        media: Vec::new(),
        index: Vec::new(),
        tables: Tables::default(),
    };
    for (id, description) in scene.media.iter().enumerate() {
        let seen = if used(id) {
            medium::assemble(description, &around, &mut assembled.tables, warnings)?
        } else {
            None
        };
        assembled
            .index
            .push(seen.as_ref().map(|_| assembled.media.len()));
        assembled.media.extend(seen);
    }
    Ok(assembled)
}

fn lights_needed(scene: &Scene, keep: &[Feature], needs: &mut Needs) {
    let distant = scene
        .lights
        .iter()
        .filter(|l| matches!(l, Light::Distant(_)))
        .count();
    let constant = scene.lights.iter().any(|l| matches!(l, Light::Constant(_)));
    let reason = match distant {
        0 => "no light that paths cannot find themselves".to_owned(),
        1 => "one distant light: no choice".to_owned(),
        n => format!("{n} distant lights, one chosen at each scattering"),
    };
    needs.decide(Feature::NextEvent, distant > 0, &[], reason);
    let (reason, keep) = if constant {
        (
            "paths that escape meet a constant sky without a shadow ray",
            keep,
        )
    } else {
        ("no environment", &[][..])
    };
    needs.decide(Feature::EnvironmentNextEvent, false, keep, reason);
}

/// Lights in single precision, times the film's factor on every pixel.
fn lights(scene: &Scene) -> Result<(Vec<Distant>, [f32; 3]), SceneError> {
    let factor = scene.film.imaging_ratio;
    let mut distant = Vec::new();
    let mut environment = [0.0_f64; 3];
    for light in &scene.lights {
        match light {
            Light::Distant(light) => {
                let direction = light.direction_to_light.as_vec3().to_array();
                let irradiance = light.irradiance.map(|e| (e * factor) as f32);
                let made = Distant::new(direction, irradiance)
                    .map_err(|error| SceneError::at(&light.place, error.to_string()))?;
                distant.push(made);
            }
            Light::Constant(light) => {
                for (sum, radiance) in environment.iter_mut().zip(light.radiance) {
                    *sum += radiance * factor;
                }
                if environment.iter().any(|e| !(*e as f32).is_finite()) {
                    let message = "the radiance is beyond the range of 32-bit numbers";
                    return Err(SceneError::at(&light.place, message));
                }
            }
            // These are the scalar integrators' own.
            Light::Image(_) | Light::Point(_) | Light::Spot(_) | Light::Goniometric(_) => {}
        }
    }
    distant.retain(|light| light.radiance() != [0.0; 3]);
    Ok((distant, environment.map(|e| e as f32)))
}

fn camera(scene: &Scene, resolution: [u32; 2], origin: DVec3) -> Camera {
    let from = &scene.camera;
    let window = &from.screen_window;
    let (projection, half) = match from.projection {
        Projection::Perspective { fov } => (
            camera::Projection::Perspective,
            libm::tan(0.5 * fov.to_radians()),
        ),
        Projection::Orthographic => (camera::Projection::Orthographic, 1.0),
    };
    let axis = |from: f64, to: f64, pixels: u32| {
        [from * half, (to - from) * half / f64::from(pixels)].map(|x| x as f32)
    };
    let to_world = DAffine3::from_translation(-origin) * from.camera_to_world;
    Camera {
        projection,
        screen: [
            axis(window.x_min, window.x_max, resolution[0]),
            axis(window.y_max, window.y_min, resolution[1]),
        ],
        camera_to_world: medium::rows(&to_world),
        lens_radius: from.lens_radius as f32,
        focal_distance: from.focal_distance as f32,
    }
}
