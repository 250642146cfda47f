//! Run time against error: what runs of several methods on one scene say, and how sure it is.
//!
//! A *run* renders a number of samples per pixel with a seed of its own and is held against a reference:
//!
//! ```text
//! relMSE = mean over pixels and channels of  ((x − r)² − Var[r]) / (r² + 10⁻² m²),    m the mean of r
//! ```
//!
//! The reference's own error is subtracted in expectation and stated. Without bias relMSE falls as one over time, so that CPU seconds
//! times relMSE, the *efficiency* (seconds to reach relMSE 1; lower is better), is one number of a method and a scene, and the
//! logarithm of relMSE over that of time is a line of slope −1 (−½ for its root). A bias does not fall: it shows as a floor,
//! and a slope above −1.

pub mod drawing;
pub mod page;
pub mod reference;
pub mod summary;

pub use reference::{Judgement, Reference};
pub use summary::{Interval, Summary};

/// One run of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Which budget: 0 is the least, each next one twice as many samples.
    pub budget: u32,
    /// Its seed.
    pub seed: u64,
    /// Samples per pixel.
    pub samples: u32,
    /// User and system time of all threads \[s\], or wall-clock time where the system does not tell.
    pub seconds: f64,
    /// How far from the reference.
    pub judgement: Judgement,
}

/// A way to render a scene, and what its runs found.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// As on the command line: `path,kernel=scalar`.
    pub name: String,
    /// In the order in which they ran.
    pub runs: Vec<Run>,
}

/// All methods on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Name of the scene.
    pub name: String,
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// How the reference came about.
    pub reference: String,
    /// relMSE of the reference itself, by its own variance.
    pub reference_error: f64,
    /// What is compared.
    pub methods: Vec<Method>,
}

impl Method {
    /// The budgets at which there are runs, ascending.
    pub fn budgets(&self) -> Vec<u32> {
        let mut budgets: Vec<u32> = self.runs.iter().map(|run| run.budget).collect();
        budgets.sort_unstable();
        budgets.dedup();
        budgets
    }

    /// The runs of a budget.
    pub fn at(&self, budget: u32) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.budget == budget)
    }
}

/// All runs as comma-separated values, with a head of names.
pub fn csv(stages: &[Stage]) -> String {
    let quote = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = String::from(
        "scene,method,width,height,budget,seed,samples_per_pixel,cpu_seconds,mse,relmse,median_block_relmse,reference_relmse\n",
    );
    for stage in stages {
        for method in &stage.methods {
            for run in &method.runs {
                let Judgement {
                    mse,
                    relative,
                    median,
                } = run.judgement;
                text += &format!(
                    "{},{},{},{},{},{},{},{:e},{mse:e},{relative:e},{median:e},{:e}\n",
                    quote(&stage.name),
                    quote(&method.name),
                    stage.size[0],
                    stage.size[1],
                    run.budget,
                    run.seed,
                    run.samples,
                    run.seconds,
                    stage.reference_error,
                );
            }
        }
    }
    text
}
