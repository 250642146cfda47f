//! Radiances, measured by one integrator after another and judged.
//!
//! A picture shows one radiance everywhere, or its mean is what is known. One sample of every pixel is a *replicate*;
//! its mean over the film is one weight, since paths of bidirectional integrators land anywhere and chains join pixels.
//! Replicates are independent, so that Student's distribution tells their mean from the truth at a false-positive rate
//! of 10⁻⁶ a comparison. Each trial may name wrong truths, as plausible slips would give them; the same judge must
//! reject each of them at ten standard errors, for every integrator whose stated resolution can see it, one at least.

use statrs::distribution::{ContinuousCDF, StudentsT};
use woodcock_core::path::ShadowEstimator;
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, Plan};
use woodcock_host::world::Feature;
use woodcock_tests::pictures::*;
use woodcock_tests::stats::{self, ALPHA, Moments, Verdict, must_kill};

pub(crate) use Integrator::{Bdpt, Mlt, Path, Single, Transmittance};

/// Relative rounding of optical depths, which are products of f32.
const ROUNDING: f64 = 1.0 / 1_048_576.0;

/// A comparison.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<'a> {
    /// Its name, which also is its seed.
    pub(crate) name: &'a str,
    /// The scene.
    pub(crate) text: &'a str,
    /// Who renders it.
    pub(crate) by: &'a [Integrator],
    /// Bound on scatterings.
    pub(crate) depth: Option<u32>,
    /// How many samples every pixel gets.
    pub(crate) replicates: u32,
    /// What must come out, by colour.
    pub(crate) truth: Xyz,
    /// Standard error of the truth, relative.
    pub(crate) truth_error: f64,
    /// Relative standard error that must be reached; less is asked of integrators that are noisier ([`slack`]).
    pub(crate) resolution: f64,
    /// What must be rejected, with the reason why it is wrong.
    pub(crate) wrong: &'a [(&'a str, Xyz)],
}

impl<'a> Trial<'a> {
    /// A comparison by path tracing with 64 replicates, to a hundredth.
    pub(crate) const fn new(name: &'a str, text: &'a str, truth: Xyz) -> Self {
        Self {
            name,
            text,
            by: &[Path],
            depth: None,
            replicates: 64,
            truth,
            truth_error: 0.0,
            resolution: 0.01,
            wrong: &[],
        }
    }

    /// Renders and judges.
    #[track_caller]
    pub(crate) fn run(&self) {
        let mut seen = vec![false; self.wrong.len()];
        for &integrator in self.by {
            let name = format!("{} by {}", self.name, integrator.name());
            let resolution = self.resolution * slack(integrator);
            let moments = self.measure(integrator, &name);
            for (channel, m) in moments.iter().enumerate() {
                let verdict = self.judge(m, channel, self.truth[channel], resolution);
                assert!(
                    verdict.agrees(),
                    "{name}, channel {channel}: mean {:.8} ± {:.1e} for {:.8}, relative {:+.2e}: {verdict:?}",
                    m.mean(),
                    m.standard_error(),
                    self.truth[channel],
                    m.mean() / self.truth[channel] - 1.0,
                );
            }
            for ((slip, wrong), seen) in self.wrong.iter().zip(&mut seen) {
                let apart = |channel: usize| (wrong[channel] / self.truth[channel] - 1.0).abs();
                let clearest = (0..3).max_by(|a, b| apart(*a).total_cmp(&apart(*b)));
                let channel = clearest.expect("three channels");
                if apart(channel) >= 11.0 * resolution {
                    let verdict =
                        self.judge(&moments[channel], channel, wrong[channel], resolution);
                    must_kill(&format!("{name}: {slip}"), verdict);
                    *seen = true;
                }
            }
        }
        for ((slip, _), seen) in self.wrong.iter().zip(seen) {
            assert!(seen, "{}: nothing here can see {slip}", self.name);
        }
    }

    fn measure(&self, integrator: Integrator, name: &str) -> [Moments; 3] {
        // Media alone would go to the packets.
        let Studio { world, .. } =
            stage_keeping(self.text, &[Feature::Surfaces, Feature::DetailedSurfaces]);
        let seed = self.name.bytes().fold(7, |seed: u64, byte| {
            seed.wrapping_mul(0x0100_0000_01b3) ^ u64::from(byte)
        });
        let plan = Plan::new(
            &world,
            Kernel::Packet,
            integrator,
            stats::seed(seed),
            ShadowEstimator::Ratio,
            self.depth,
        );
        assert!(!plan.in_packets(&world), "{name}: packets take it");
        let studio = Studio { world, plan };
        let mut moments = [Moments::new(); 3];
        for replicate in 0..stats::samples(self.replicates as usize) as u32 {
            let picture = studio.shoot_range(replicate..replicate + 1);
            picture.assert_sound(name);
            for (channel, moments) in moments.iter_mut().enumerate() {
                moments.push(picture.moments(channel).mean());
            }
        }
        moments
    }

    fn error(&self, m: &Moments, truth: f64) -> f64 {
        m.standard_error()
            .hypot(self.truth_error * truth.abs())
            .hypot(ROUNDING * truth.abs())
    }

    fn judge(&self, m: &Moments, channel: usize, truth: f64, resolution: f64) -> Verdict {
        let error = self.error(m, truth);
        let z = (m.mean() - truth) / error;
        let scale = self.truth[channel].abs();
        if !(error <= resolution * scale && z.is_finite()) {
            return Verdict::Blind {
                resolution: error / scale,
            };
        }
        let freedom = m.count() as f64 - 1.0;
        let law = StudentsT::new(0.0, 1.0, freedom).expect("several replicates");
        if z.abs() < law.inverse_cdf(1.0 - ALPHA / 2.0) {
            Verdict::Agrees
        } else {
            Verdict::Biased { z }
        }
    }
}

/// How much less is asked of an integrator, for the same number of paths.
const fn slack(integrator: Integrator) -> f64 {
    match integrator {
        Path | Single | Transmittance => 1.0,
        Bdpt => 1.5,
        Mlt => 3.0,
    }
}

/// Numbers in brackets.
pub(crate) fn list(values: &[f64]) -> String {
    let text: Vec<_> = values.iter().map(f64::to_string).collect();
    format!("[ {} ]", text.join(" "))
}

/// A parallelogram with centre and half edges; its normal is u × v.
pub(crate) fn quad(centre: Xyz, u: Xyz, v: Xyz) -> String {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let points =
        corners.map(|[a, b]| -> Xyz { std::array::from_fn(|i| centre[i] + a * u[i] + b * v[i]) });
    format!(
        "Shape \"trianglemesh\" \"point3 P\" {} \"integer indices\" [ 0 1 2 0 2 3 ]",
        list(points.as_flattened())
    )
}

/// A square across the z axis at a height, facing up or down.
pub(crate) fn level(z: f64, half: f64, up: bool) -> String {
    let side = if up { half } else { -half };
    quad([0.0, 0.0, z], [side, 0.0, 0.0], [0.0, half, 0.0])
}

/// A shape of a material, and no boundary of media.
pub(crate) fn made_of(material: &str, shape: &str) -> String {
    within("", "", material, shape)
}

/// A shape of a material that parts media.
pub(crate) fn within(inside: &str, outside: &str, material: &str, shape: &str) -> String {
    format!(
        "AttributeBegin\nMediumInterface \"{inside}\" \"{outside}\"\nMaterial {material}\n{shape}\nAttributeEnd\n"
    )
}

/// A Lambertian material.
pub(crate) fn matte(reflectance: Xyz) -> String {
    format!("\"diffuse\" \"rgb reflectance\" {}", list(&reflectance))
}

/// What reflects nothing.
pub(crate) fn black() -> String {
    matte([0.0; 3])
}

/// Smooth transparent matter.
pub(crate) fn glass(eta: f64) -> String {
    format!("\"dielectric\" \"float eta\" {eta}")
}

/// A shape that shines to where its normal points, and reflects nothing.
pub(crate) fn lamp(radiance: Xyz, shape: &str) -> String {
    let light = format!(
        "AreaLightSource \"diffuse\" \"rgb L\" {}\n",
        list(&radiance)
    );
    made_of(&black(), &(light + shape))
}

/// A point of intensity I.
pub(crate) fn point_light(from: Xyz, intensity: Xyz) -> String {
    format!(
        "LightSource \"point\" \"point3 from\" {} \"rgb I\" {}\n",
        list(&from),
        list(&intensity)
    )
}

/// A camera within a medium that fills space.
pub(crate) fn in_fog(fog: &str, name: &str, camera: &str) -> String {
    format!("{fog}MediumInterface \"\" \"{name}\"\n{camera}")
}

/// A ray through a place, from `distance` before it.
pub(crate) fn ray_to(place: Xyz, direction: Xyz, distance: f64) -> String {
    let from = std::array::from_fn(|i| place[i] - distance * direction[i]);
    single_ray(from, direction)
}

pub(crate) fn length(v: Xyz) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A truth changed by a factor.
pub(crate) fn times(truth: Xyz, factor: f64) -> Xyz {
    truth.map(|t| t * factor)
}
