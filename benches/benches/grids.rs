//! Free flights through grids: how samples are kept and looked up, and how large blocks are.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench grids
//! cargo bench -p woodcock-benches --bench grids -- 512    # storage only, of these sides
//! ```
//!
//! Every round runs each row of a table once, so that rows meet the same noise; ratios are medians of those within
//! rounds, against the first row. One thread. `--test` runs each row once, on the smallest grids.
#![forbid(unsafe_code)]

use std::error::Error;
use std::hint::black_box;

use woodcock_benches::{BUNDLES, Cube, RAYS, Times, Work, quick};
use woodcock_core::free_flight::{Flight, delta};
use woodcock_core::majorant::{
    EDGES, MajorantGrid, Process, Stages, block_counts, coarsen, fill_leaps, fill_slab,
    majorant_count_of, walk_cost,
};
use woodcock_core::medium::{Grid, IDENTITY, Interpolated, Medium};
use woodcock_core::path::{MediumRecord, OneGrid, RecordKind, Store, Tapped};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::Stream;
use woodcock_core::vec3::Vec3;
use woodcock_host::world::BrickTables;
use woodcock_packet::both::Wide;
use woodcock_packet::bundle::{BundleRay, Schedule, free_flights, run};

/// Flights that are decided as paths decide them: by [`Tapped::decide`].
struct Decided<R: Real, W> {
    stages: Stages<R, W>,
    collided: R::Mask,
}

impl<R: Real, W: Clone> Decided<R, W> {
    fn idle<M: Medium<R, Walk = W>>(medium: &M) -> Self {
        Self {
            stages: Stages::idle(medium),
            collided: R::Mask::splat(false),
        }
    }
}

impl<R: Real, M: Tapped<R>> Process<R, M> for Decided<R, M::Walk> {
    #[inline(always)]
    fn stages(&mut self) -> &mut Stages<R, M::Walk> {
        &mut self.stages
    }
    #[inline(always)]
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        self.stages.begin(medium, ray, t_max, rng, active);
        self.collided = self.collided.and_not(active);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let lanes = self.stages.tentative();
        let tracker = &self.stages.tracker;
        let tap = medium.tap(&tracker.walk, tracker.t(), rng, lanes);
        let majorant = tracker.majorant(medium);
        let decided = medium.decide(&tracker.walk, tap, majorant, rng, lanes);
        self.collided = self.collided | decided.real;
        self.stages.resolve::<M>(rng, lanes.and_not(decided.real));
    }
    #[inline(always)]
    fn result(&self) -> R {
        let t = self.stages.tracker.t();
        Flight {
            t,
            collided: self.collided,
        }
        .or_infinite()
    }
}

type Values = Vec<Vec<f32>>;

/// What flies rays through a medium, and counts.
type Fly<'a> = Box<dyn Fn(&Work, &mut Values) + 'a>;

/// A way to fly, and how long it took.
struct Row<'a> {
    name: String,
    fly: Fly<'a>,
    values: Values,
    times: Times,
}

impl<'a> Row<'a> {
    fn new(name: String, fly: impl Fn(&Work, &mut Values) + 'a) -> Self {
        Self {
            name,
            fly: Box::new(fly),
            values: vec![vec![0.0; RAYS]; BUNDLES],
            times: Times::default(),
        }
    }
}

fn world_ray(ray: &BundleRay) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(ray.origin),
        direction: Vec3::splat(ray.direction),
    }
}

/// The flights of delta tracking in both widths.
fn delta_rows<'a, M: Medium<f32> + Medium<Wide>>(medium: &'a M, name: &str) -> [Row<'a>; 2] {
    [
        Row::new(format!("{name}/x1"), move |work, values| {
            for (bundle, out) in work.singles.iter().zip(values) {
                for ((ray, stream), out) in bundle.iter().zip(out) {
                    let mut stream = stream.clone();
                    *out = delta::sample(medium, &world_ray(ray), ray.t_max, &mut stream, true)
                        .or_infinite();
                }
            }
        }),
        Row::new(format!("{name}/x16"), move |work, values| {
            for (bundle, out) in work.bundles.iter().zip(values) {
                free_flights(medium, bundle, Schedule::Refill, out);
            }
        }),
    ]
}

/// The same flights, decided as paths decide them.
fn decided_rows<'a, M: Tapped<f32> + Tapped<Wide>>(medium: &'a M, name: &str) -> [Row<'a>; 2] {
    [
        Row::new(format!("{name}/x1"), move |work, values| {
            for (bundle, out) in work.singles.iter().zip(values) {
                for ((ray, stream), out) in bundle.iter().zip(out) {
                    let (mut stream, mut state) = (stream.clone(), Decided::idle(medium));
                    let ray_ws = world_ray(ray);
                    Process::begin(&mut state, medium, &ray_ws, ray.t_max, &mut stream, true);
                    state.run(medium, &mut stream);
                    *out = Process::<f32, M>::result(&state);
                }
            }
        }),
        Row::new(format!("{name}/x16"), move |work, values| {
            for (bundle, out) in work.bundles.iter().zip(values) {
                let mut state = Decided::idle(medium);
                run(medium, &mut state, bundle, Schedule::Refill, out);
            }
        }),
    ]
}

/// Runs the rows in rounds and prints them.
fn table(title: &str, rows: &mut [Row<'_>], works: &[Work], rounds: usize) {
    for work in works.iter().cycle().take(rounds) {
        for row in rows.iter_mut() {
            let (fly, values) = (&row.fly, &mut row.values);
            row.times.time(|| fly(work, values));
            black_box(&row.values);
        }
    }
    println!(
        "\n{title}\n{:<28} {:>9} {:>19} {:>7}",
        "row", "ns/path", "quartiles", "x"
    );
    let Some((first, _)) = rows.split_first() else {
        return;
    };
    for row in rows.iter() {
        let ns = |q: f64| row.times.quantile(q) * 1e9 / Work::PATHS as f64;
        println!(
            "{:<28} {:>9.1} {:>9.1}-{:<9.1} {:>7.2}",
            row.name,
            ns(0.5),
            ns(0.25),
            ns(0.75),
            row.times.speed_up_over(&first.times)
        );
    }
}

/// Edges of blocks, and the bounds of each.
type Levels = Vec<(u32, Vec<f32>)>;

/// Bounds of a grid in blocks of each edge, with leaps.
fn levels(samples: &[f32], dims: [u32; 3]) -> Result<Levels, Box<dyn Error>> {
    let count = |edge| majorant_count_of(dims, edge).ok_or("too many blocks");
    let mut tables = vec![vec![0.0; count(EDGES[0])?]];
    let [x, y, _] = block_counts(dims, EDGES[0]).map(|n| n as usize + 2);
    for (slab, entries) in tables[0].chunks_exact_mut(x * y).enumerate() {
        fill_slab(samples, dims, EDGES[0], slab, entries)?;
    }
    for pair in EDGES.windows(2) {
        let mut coarse = vec![0.0; count(pair[1])?];
        let fine = tables.last().ok_or("no level")?;
        coarsen(fine, block_counts(dims, pair[0]), &mut coarse)?;
        tables.push(coarse);
    }
    let mut levels = Vec::new();
    for (edge, mut table) in EDGES.into_iter().zip(tables) {
        fill_leaps(&mut table, block_counts(dims, edge))?;
        levels.push((edge, table));
    }
    Ok(levels)
}

/// The level that the cost model picks.
fn chosen(levels: &[(u32, Vec<f32>)], dims: [u32; 3], depth: f64) -> Result<usize, Box<dyn Error>> {
    let mut best = (0, f64::INFINITY);
    for (at, (edge, table)) in levels.iter().enumerate() {
        let cost = walk_cost(table, dims, *edge, depth)?.total();
        if cost < best.1 {
            best = (at, cost);
        }
    }
    Ok(best.0)
}

fn record(side: u32, edge: u32, scale: f32) -> MediumRecord {
    MediumRecord {
        kind: RecordKind::Grid {
            world_to_grid: IDENTITY,
            dims: [side; 3],
            samples: 0,
            majorants: 0,
            edge,
        },
        scale,
        colour: [1.0; 3],
        albedo: [1.0; 3],
        g: 0.0,
        rayleigh: false,
    }
}

/// How much faster one row is than another, with quartiles of the ratios within rounds.
fn ratio(rows: &[Row<'_>], what: &str, slow: &str, fast: &str) {
    let times = |name: &str| {
        rows.iter()
            .find(|row| row.name == name)
            .map(|row| &row.times)
    };
    if let Some((slow, fast)) = times(slow).zip(times(fast)) {
        let ratios = fast.ratios(slow);
        let at = |q| ratios.quantile(q);
        println!(
            "{what:<44} {:>6.2} ({:.2}-{:.2})",
            at(0.5),
            at(0.25),
            at(0.75)
        );
    }
}

/// How samples are kept and looked up, on flights from anywhere to anywhere: no two rays of a round or of the next rounds are alike, so
/// that a table beyond the caches is missed as by paths after many scatterings.
fn storage(side: u32, rounds: usize) -> Result<(), Box<dyn Error>> {
    let cube = Cube::new(side)?;
    let (dims, last) = ([side; 3], (side - 1) as f32);
    let scale = 8.0 / last;
    let levels = levels(&cube.samples, dims)?;
    let (edge, bounds) = &levels[chosen(&levels, dims, f64::from(scale))?];
    let grid = MajorantGrid::with_edge(&cube.samples, dims, *edge, bounds)?;
    let grid = Grid::new(grid, IDENTITY, scale).ok_or("a grid out of range")?;
    let trilinear = Interpolated(grid);
    let record = record(side, *edge, scale);
    let dense = OneGrid::new(&record, &cube.samples, bounds);
    let tables = BrickTables::of_dense(&cube.samples, dims).ok_or("too many samples")?;
    let bricks = OneGrid::stored(&record, Store::Bricks(tables.borrow()), bounds);
    let batches = if quick() { 1 } else { 16 };
    let works: Vec<Work> = (0..batches)
        .map(|batch| Work::scattered(last, batch))
        .collect();
    let mut rows: Vec<Row<'_>> = Vec::new();
    rows.extend(delta_rows(&trilinear, "dense/trilinear"));
    rows.extend(decided_rows(&dense, "dense/one-tap"));
    rows.extend(delta_rows(&bricks, "bricks/one-tap"));
    rows.extend(decided_rows(&bricks, "bricks/squeeze"));
    let voxels = (tables.present() * 512) as f64;
    let title = format!(
        "{side}³, blocks of {edge}; bricks take {:.3} bytes a voxel, 4 of them its sample",
        tables.bytes() as f64 / voxels
    );
    table(&title, &mut rows, &works, rounds);
    ratio(
        &rows,
        "one tap against interpolation, dense, x16",
        "dense/trilinear/x16",
        "dense/one-tap/x16",
    );
    ratio(
        &rows,
        "bricks with bytes against dense, one tap, x16",
        "dense/one-tap/x16",
        "bricks/squeeze/x16",
    );
    ratio(
        &rows,
        "bytes against none, bricks, x16",
        "bricks/one-tap/x16",
        "bricks/squeeze/x16",
    );
    ratio(
        &rows,
        "bricks with bytes against interpolation, x16",
        "dense/trilinear/x16",
        "bricks/squeeze/x16",
    );
    assert!(
        rows[2..]
            .windows(2)
            .all(|two| two[0].values == two[1].values),
        "lanes or storage changed a result"
    );
    Ok(())
}

/// How large blocks are, in a sparse cloud: a few balls of what the cube holds.
fn blocks(side: u32, optical_depth: f32, rounds: usize) -> Result<(), Box<dyn Error>> {
    let cube = Cube::new(side)?;
    let (dims, last) = ([side; 3], (side - 1) as f32);
    let balls = [
        ([0.3, 0.35, 0.4], 0.2),
        ([0.62, 0.6, 0.5], 0.24),
        ([0.45, 0.75, 0.7], 0.15),
    ];
    let inside = |n: usize| {
        let n = n as u32;
        let p = [n % side, n / side % side, n / side / side].map(|i| i as f32 / last);
        balls.iter().any(|(centre, radius)| {
            let squares: f32 = (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum();
            squares < radius * radius
        })
    };
    let samples: Vec<f32> = (0..)
        .zip(&cube.samples)
        .map(|(n, v)| if inside(n) { *v } else { 0.0 })
        .collect();
    let empty = samples.iter().filter(|v| **v == 0.0).count() as f64 / samples.len() as f64;
    let scale = optical_depth / last;
    let levels = levels(&samples, dims)?;
    let chosen = chosen(&levels, dims, f64::from(scale))?;
    // One bound for all, in the largest blocks.
    let (largest_edge, coarsest) = levels.last().ok_or("no level")?;
    let whole = coarsest.iter().copied().fold(0.0, f32::max);
    let [x, y, z] = block_counts(dims, *largest_edge).map(|n| n as usize + 2);
    let one: Vec<f32> = (0..x * y * z)
        .map(|n| {
            let inner = |i: usize, of: usize| (1..of - 1).contains(&i);
            let at = inner(n % x, x) && inner(n / x % y, y) && inner(n / x / y, z);
            if at { whole } else { 0.0 }
        })
        .collect();
    let record_one = record(side, *largest_edge, scale);
    let single = OneGrid::new(&record_one, &samples, &one);
    let media: Vec<_> = levels
        .iter()
        .map(|(edge, table)| OneGrid::new(&record(side, *edge, scale), &samples, table))
        .collect();
    let work = Work::new(last);
    let mut rows: Vec<Row<'_>> = Vec::new();
    rows.extend(decided_rows(&single, "one majorant").into_iter().skip(1));
    for (at, medium) in media.iter().enumerate() {
        let mark = if at == chosen { " (chosen)" } else { "" };
        let name = format!("blocks of {}{mark}", levels[at].0);
        rows.extend(decided_rows(medium, &name).into_iter().skip(1));
    }
    let title = format!(
        "{side}³, {:.0} % empty, largest optical depth {optical_depth}",
        100.0 * empty
    );
    table(&title, &mut rows, &[work], rounds);
    for (edge, table) in &levels {
        let cost = walk_cost(table, dims, *edge, f64::from(scale))?;
        println!(
            "model, blocks of {edge:<2}: {:.4} crossings and {:.4} collisions a voxel, cost {:.4}",
            cost.crossings,
            cost.collisions,
            cost.total()
        );
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let named: Vec<u32> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let (sides, rounds): (&[u32], usize) = match (quick(), named.as_slice()) {
        (true, _) => (&[64], 1),
        (false, []) => (&[64, 96, 128, 192, 256, 512], 32),
        (false, named) => (named, 32),
    };
    for side in sides {
        storage(*side, rounds)?;
    }
    if !named.is_empty() {
        return Ok(());
    }
    let side = if quick() { 64 } else { 256 };
    for depth in [4.0, 40.0, 400.0] {
        blocks(side, depth, rounds)?;
    }
    Ok(())
}
