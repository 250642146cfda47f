//! Which scenes are rooms, and the tables that their paths walk among.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use woodcock_core::room::{Ball, Flat, Fog, Lamp, LampLight, Matter, Room, Sheet};

use super::flats::{self, Piece};
use crate::render::Plan;
use crate::scene::{Light, MaterialKind, Projection, Scene, Shape, Surface, Texture};
use crate::world::{Location, Medium, PhaseFunction, World};

/// Most pieces that every ray is compared with; beyond that a tree is faster.
const MOST_PIECES: usize = 32;
/// Most lamps.
const MOST_LAMPS: usize = 8;
/// What pieces must at least measure, in parts of the scene: single precision shifts rays by 10⁻⁶ of it.
const LEAST: f64 = 1.0 / 32.0;
/// What is as good as no distance between pieces, in parts of the scene.
const NEAR: f64 = 1e-4;

/// The tables of a [`Room`].
#[derive(Debug)]
pub(crate) struct Blueprint {
    flats: Vec<Flat>,
    balls: Vec<Ball>,
    matter: Vec<f32>,
    lamps: Vec<Lamp>,
    shining: u32,
    walls: u32,
    camera_within: bool,
    fog: Option<Fog>,
    step: f32,
}

/// Why a scene is no room.
type Refusal = &'static str;

/// Something with matter, before its numbers are single.
struct Made {
    shape: MadeShape,
    reflectance: [f64; 3],
    /// Radiance, and whether the back shines too.
    emission: Option<([f64; 3], bool)>,
}

enum MadeShape {
    Flat(Piece),
    Ball(DVec3, f64),
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

impl Blueprint {
    /// The tables of a scene.
    ///
    /// * `origin`: the place of the world that becomes the origin of rendering.
    ///
    /// # Errors
    /// Why it is no room.
    pub(crate) fn new(
        scene: &Scene,
        origin: DVec3,
        media: &[Medium],
        place: &Location,
    ) -> Result<Self, Refusal> {
        if !scene.instances.is_empty() {
            return Err("instances");
        }
        let factor = scene.film.imaging_ratio;
        let mut made = Vec::new();
        for surface in &scene.surfaces {
            made.extend(pieces(scene, surface, origin, factor)?);
            if made.len() > MOST_PIECES {
                return Err("more pieces than are met one by one");
            }
        }
        let size = size(scene, origin, &made);
        check_sizes(&made, size)?;
        let walls = Walls::new(scene, origin, &made, size);
        // Those that shine come first, then others, walls, and balls.
        made.sort_by_key(|m| {
            let ball = matches!(m.shape, MadeShape::Ball(..));
            (ball, walls.has(m), m.emission.is_none())
        });
        let fog = fog(media, place)?;
        let lamps = lamps(scene, origin, &made, size)?;
        let mut blueprint = Self {
            flats: Vec::new(),
            balls: Vec::new(),
            matter: Vec::new(),
            walls: made.iter().filter(|m| walls.has(m)).count() as u32,
            camera_within: made.iter().all(|m| walls.hold_camera(m)),
            shining: made.iter().filter(|m| m.emission.is_some()).count() as u32,
            lamps,
            fog,
            step: (f64::from(woodcock_core::room::STEP) * size) as f32,
        };
        for piece in &made {
            blueprint
                .add(piece, size)
                .ok_or("numbers beyond single precision")?;
        }
        Ok(blueprint)
    }

    fn add(&mut self, made: &Made, size: f64) -> Option<()> {
        let (normal, centre, radius) = match made.shape {
            MadeShape::Flat(piece) => {
                let edges = piece.edges.map(|edge| edge.to_array());
                let flat = Flat::new(piece.corner.to_array(), edges, piece.triangle, size)?;
                self.flats.push(flat);
                (flat.normal(), piece.centre(), 0.0)
            }
            MadeShape::Ball(centre, radius) => {
                self.balls.push(Ball::new(centre.to_array(), radius)?);
                ([0.0; 3], centre, radius as f32)
            }
        };
        let matter = Matter {
            normal,
            centre: single(centre),
            reflectance: made.reflectance.map(|r| r as f32),
            radius,
        };
        self.matter.extend(matter.words());
        Some(())
    }

    /// What it says, in a few words.
    pub(crate) fn summary(&self) -> String {
        format!(
            "{} plane pieces and {} balls, all diffuse: eight rays at a time",
            self.flats.len(),
            self.balls.len()
        )
    }

    /// The room, for kernels.
    pub(crate) fn room<'a>(&'a self, world: &'a World, plan: &Plan) -> Room<'a> {
        Room {
            flats: &self.flats,
            balls: &self.balls,
            matter: &self.matter,
            lamps: &self.lamps,
            shining: self.shining,
            walls: self.walls,
            camera_within: self.camera_within,
            environment: world.environment,
            fog: self.fog,
            camera: &world.camera,
            step: self.step,
            points: plan.settings.points && plan.replicate > 1,
            max_depth: plan.settings.max_depth,
        }
    }
}

/// The reflectance of a texture without pictures.
fn constant(texture: &Texture) -> Option<[f64; 3]> {
    let mut factor = [1.0; 3];
    let mut left = vec![texture];
    while let Some(texture) = left.pop() {
        match texture {
            Texture::Constant(value) => {
                factor = [0, 1, 2].map(|c| factor[c] * value[c]);
            }
            Texture::Scale(a, b) => left.extend([&**a, &**b]),
            Texture::Image(_) => return None,
        }
    }
    Some(factor.map(|f| f.clamp(0.0, 1.0)))
}

/// The pieces of a surface.
fn pieces(
    scene: &Scene,
    surface: &Surface,
    origin: DVec3,
    factor: f64,
) -> Result<Vec<Made>, Refusal> {
    let emission = surface
        .emission
        .filter(|e| e.radiance.iter().any(|&r| r > 0.0))
        .map(|e| (e.radiance.map(|r| r * factor), e.two_sided));
    let Some(material) = surface.material else {
        return match emission {
            // Neither light nor path can notice it.
            None => Ok(Vec::new()),
            Some(_) => Err("surfaces that shine and let light pass"),
        };
    };
    let kind = scene.materials.get(material.0).map(|m| &m.kind);
    let Some(MaterialKind::Diffuse { reflectance }) = kind else {
        return Err("materials that are not diffuse");
    };
    let reflectance = constant(reflectance).ok_or("pictures on surfaces")?;
    let flat = |pieces: Option<Vec<Piece>>| pieces.ok_or("patches that are no parallelograms");
    let bent = "normals of shading";
    let flats = match &surface.shape {
        Shape::TriangleMesh(mesh) if !mesh.normals.is_empty() => return Err(bent),
        Shape::BilinearMesh(mesh) if !mesh.normals.is_empty() => return Err(bent),
        Shape::TriangleMesh(mesh) if mesh.indices.len() > 2 * MOST_PIECES => {
            return Err("more pieces than are met one by one");
        }
        Shape::TriangleMesh(mesh) => flat(flats::of_triangles(mesh, origin))?,
        Shape::BilinearMesh(mesh) => flat(flats::of_patches(mesh, origin))?,
        Shape::Sphere(sphere) => {
            if emission.is_some() {
                return Err("balls that shine");
            }
            let map = sphere.object_to_world;
            let scale = uniform_scale(map.matrix3).ok_or("ellipsoids")?;
            let shape = MadeShape::Ball(map.translation - origin, sphere.radius * scale);
            return Ok(vec![Made {
                shape,
                reflectance,
                emission,
            }]);
        }
        Shape::Disk(_) => return Err("disks"),
    };
    let made = |piece: Piece| Made {
        shape: MadeShape::Flat(if surface.flipped {
            piece.turned()
        } else {
            piece
        }),
        reflectance,
        emission,
    };
    Ok(flats.into_iter().map(made).collect())
}

/// The factor by which a map scales all lengths, if it does so alike.
fn uniform_scale(map: DMat3) -> Option<f64> {
    let scale = map.x_axis.length();
    let square = map.transpose() * map;
    let off = square - DMat3::from_diagonal(DVec3::splat(scale * scale));
    let largest = off
        .to_cols_array()
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    (largest < 1e-9 * scale * scale).then_some(scale)
}

/// The largest coordinate of the pieces, of lamps and of the camera.
fn size(scene: &Scene, origin: DVec3, made: &[Made]) -> f64 {
    let mut size = 0.0_f64;
    let mut add = |p: DVec3| size = size.max(p.abs().max_element());
    for made in made {
        match made.shape {
            MadeShape::Flat(piece) => piece.corners().into_iter().for_each(&mut add),
            MadeShape::Ball(centre, radius) => add(centre.abs() + radius),
        }
    }
    let (place, radius) = camera(scene, origin);
    add(place.abs()
        + if radius.is_finite() {
            radius
        } else {
            film(scene)
        });
    for light in &scene.lights {
        if let Light::Point(point) = light {
            add(point.position - origin);
        }
    }
    size
}

/// How far the corners of a film of parallel rays are from its middle, at most.
fn film(scene: &Scene) -> f64 {
    let window = &scene.camera.screen_window;
    let reach = |a: f64, b: f64| a.abs().max(b.abs());
    let unit = scene.camera.camera_to_world.matrix3.x_axis.length();
    unit * (reach(window.x_min, window.x_max) + reach(window.y_min, window.y_max))
}

/// Which pieces have everything on one side.
struct Walls {
    /// All corners, lamps at points, and balls with their radius.
    places: Vec<(DVec3, f64)>,
    camera: (DVec3, f64),
    /// What is as good as no distance.
    near: f64,
}

impl Walls {
    fn new(scene: &Scene, origin: DVec3, made: &[Made], size: f64) -> Self {
        let mut places = Vec::new();
        for made in made {
            match made.shape {
                MadeShape::Flat(piece) => {
                    places.extend(piece.corners().into_iter().map(|p| (p, 0.0)));
                }
                MadeShape::Ball(centre, radius) => places.push((centre, radius)),
            }
        }
        for light in &scene.lights {
            if let Light::Point(point) = light {
                places.push((point.position - origin, 0.0));
            }
        }
        Self {
            places,
            camera: camera(scene, origin),
            near: f64::from(woodcock_core::room::STEP) * size,
        }
    }

    /// Whether a piece has all places on one side: 1 or −1 for that of its normal or the other, if so.
    fn side(&self, made: &Made) -> Option<f64> {
        let (MadeShape::Flat(piece), None) = (&made.shape, made.emission) else {
            return None;
        };
        let normal = piece.normal().normalize_or_zero();
        let all_on = |side: f64| {
            let ahead = |(place, radius): &(DVec3, f64)| {
                side * (*place - piece.corner).dot(normal) >= radius - self.near
            };
            self.places.iter().all(ahead)
        };
        [1.0, -1.0].into_iter().find(|side| all_on(*side))
    }

    fn has(&self, made: &Made) -> bool {
        self.side(made).is_some()
    }

    /// Whether a piece is no wall, or one that has the camera on the side of all else.
    fn hold_camera(&self, made: &Made) -> bool {
        let (MadeShape::Flat(piece), Some(side)) = (&made.shape, self.side(made)) else {
            return true;
        };
        let (camera, radius) = self.camera;
        let normal = piece.normal().normalize_or_zero();
        side * (camera - piece.corner).dot(normal) >= radius + self.near
    }
}

/// Where the camera is, and how large.
fn camera(scene: &Scene, origin: DVec3) -> (DVec3, f64) {
    let camera = &scene.camera;
    let unit = camera.camera_to_world.matrix3.x_axis.length();
    // Parallel rays begin anywhere on the film.
    let radius = match camera.projection {
        Projection::Perspective { .. } => camera.lens_radius * unit,
        Projection::Orthographic => f64::INFINITY,
    };
    (camera.camera_to_world.translation - origin, radius)
}

fn check_sizes(made: &[Made], size: f64) -> Result<(), Refusal> {
    let least = |made: &Made| match made.shape {
        MadeShape::Flat(piece) => piece.least_height(),
        MadeShape::Ball(_, radius) => radius,
    };
    if !made.iter().all(|made| least(made) >= LEAST * size) {
        return Err("pieces too small beside the scene for single precision");
    }
    let flats = || {
        made.iter().filter_map(|made| match made.shape {
            MadeShape::Flat(piece) => Some(piece),
            MadeShape::Ball(..) => None,
        })
    };
    let covered = flats()
        .enumerate()
        .any(|(i, a)| flats().skip(i + 1).any(|b| a.covers(&b, NEAR * size)));
    if covered {
        return Err("pieces on top of one another");
    }
    Ok(())
}

/// The one medium, if it is a grey homogeneous one of a law that packets know, in one convex shape.
fn fog(media: &[Medium], place: &Location) -> Result<Option<Fog>, Refusal> {
    let region = match place {
        Location::Nowhere => return Ok(None),
        Location::Convex(convex) => *convex,
        Location::Boundaries(_) => return Err("several media, or one between any surfaces"),
    };
    let [medium] = media else {
        return Err("several media");
    };
    let record = &medium.record;
    let g = match medium.phase {
        PhaseFunction::Isotropic => 0.0,
        PhaseFunction::HenyeyGreenstein { g } => g,
        _ => return Err("phase functions other than Henyey and Greenstein's"),
    };
    if medium.support.is_some() || medium.details.is_some() {
        return Err("a medium that is not homogeneous");
    }
    if medium.is_chromatic() {
        return Err("coloured extinction");
    }
    let sigma_t = record.scale * record.colour[0];
    if sigma_t <= 0.0 {
        return Ok(None);
    }
    Ok(Some(Fog {
        sigma_t,
        albedo: record.albedo,
        g,
        region,
    }))
}

/// The lamps: pieces that shine in their order, then points and directions.
fn lamps(scene: &Scene, origin: DVec3, made: &[Made], size: f64) -> Result<Vec<Lamp>, Refusal> {
    let mean = |c: [f64; 3]| (c[0] + c[1] + c[2]) / 3.0;
    let factor = scene.film.imaging_ratio;
    let mut found: Vec<(LampLight, [f64; 3], f64)> = Vec::new();
    for made in made {
        if let (MadeShape::Flat(piece), Some((radiance, two_sided))) = (&made.shape, made.emission)
        {
            let edges = piece.edges.map(|edge| edge.to_array());
            let sheet = Sheet::new(piece.corner.to_array(), edges, piece.triangle, two_sided);
            let light = LampLight::Flat(sheet.ok_or("numbers beyond single precision")?);
            let sides = if two_sided { 2.0 } else { 1.0 };
            found.push((light, radiance, PI * mean(radiance) * piece.area() * sides));
        }
    }
    for light in &scene.lights {
        let (light, radiance, reach) = match light {
            Light::Constant(_) => continue,
            Light::Point(light) => {
                let place = LampLight::Point(single(light.position - origin));
                (place, light.intensity, 4.0 * PI)
            }
            Light::Distant(light) => {
                let direction = LampLight::Direction(single(light.direction_to_light.normalize()));
                (direction, light.irradiance, 3.0 * PI * size * size)
            }
            Light::Image(_) | Light::Spot(_) | Light::Goniometric(_) => {
                return Err("lamps with pictures or cones");
            }
        };
        let radiance = radiance.map(|r| r * factor);
        if mean(radiance) > 0.0 {
            found.push((light, radiance, reach * mean(radiance)));
        }
    }
    if found.len() > MOST_LAMPS {
        return Err("more lamps than are chosen from one by one");
    }
    let total: f64 = found.iter().map(|(_, _, power)| power).sum();
    let number = found.len() as f64;
    // Half of all evenly: power does not know what is hidden.
    let lamp = |(light, radiance, power): (LampLight, [f64; 3], f64)| Lamp {
        light,
        radiance: radiance.map(|r| r as f32),
        choice: if number > 1.0 {
            (0.5 / number + 0.5 * power / total) as f32
        } else {
            1.0
        },
    };
    Ok(found.into_iter().map(lamp).collect())
}
