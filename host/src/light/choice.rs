//! Which light to ask at a place.
//!
//! | lights | the choice |
//! |---|---|
//! | one | none, and no random number is used |
//! | several that are far away | fixed shares: half of all evenly, half by power |
//! | several at places | the [tree](super::tree), by what each may matter at the place, however few there are |
//! | both kinds | those at places have one share together, as if they were one more light far away; none where none of them can shine |
//!
//! Fixed shares do not know what is hidden: by the even half a lamp in a room keeps its part beside a sun that no
//! window lets in. Every light that can contribute has a positive probability, and all sum to one.

use glam::DVec3;

use super::discrete::{BELOW_ONE, Discrete};
use super::tree::{Extent, Tree};

/// Where a light stands in the choice.
#[derive(Clone, Copy, Debug)]
enum Seat {
    /// It never shines.
    Dark,
    Far(u32),
    Local(u32),
}

/// What lights are chosen by.
#[derive(Debug, Default)]
pub(super) struct Chooser {
    seats: Vec<Seat>,
    far: Vec<u32>,
    far_shares: Discrete,
    local: Vec<u32>,
    tree: Tree,
    /// Of all lights at places together, where any of them shines and others are far away.
    local_share: f64,
}

/// What the choice should know of a light.
pub(super) struct Candidate {
    /// Power \[W\], zero for lights that never shine.
    pub(super) power: f64,
    /// Where it is; `None` is far away.
    pub(super) extent: Option<Extent>,
}

impl Chooser {
    /// * `scale`: length that the distances of the scene are to be compared with, positive.
    pub(super) fn new(candidates: impl Iterator<Item = Candidate>, scale: f64) -> Self {
        let mut chooser = Self::default();
        let mut extents = Vec::new();
        let (mut far_powers, mut local_power) = (Vec::new(), 0.0);
        for (light, candidate) in candidates.enumerate() {
            let light = light as u32;
            let seat = match candidate {
                Candidate { power, .. } if power <= 0.0 => Seat::Dark,
                Candidate {
                    power,
                    extent: None,
                } => {
                    far_powers.push(power);
                    chooser.far.push(light);
                    Seat::Far(chooser.far.len() as u32 - 1)
                }
                Candidate {
                    extent: Some(extent),
                    ..
                } if extent.strength <= 0.0 => Seat::Dark,
                Candidate {
                    power,
                    extent: Some(extent),
                } => {
                    local_power += power;
                    extents.push(extent);
                    chooser.local.push(light);
                    Seat::Local(chooser.local.len() as u32 - 1)
                }
            };
            chooser.seats.push(seat);
        }
        let far_power: f64 = far_powers.iter().sum();
        let groups = far_powers.len() as f64 + if extents.is_empty() { 0.0 } else { 1.0 };
        let share = |power: f64| 0.5 / groups + 0.5 * (power / (far_power + local_power));
        chooser.far_shares = Discrete::new(far_powers.iter().map(|power| share(*power)));
        chooser.local_share = match (chooser.far.is_empty(), extents.is_empty()) {
            (_, true) => 0.0,
            (true, false) => 1.0,
            (false, false) => share(local_power),
        };
        chooser.tree = Tree::new(&extents, scale);
        chooser
    }

    /// Whether there is nothing to choose.
    pub(super) fn is_empty(&self) -> bool {
        self.far.is_empty() && self.local.is_empty()
    }

    /// The share of all lights at places together.
    fn local_share(&self, from: DVec3, normal: DVec3) -> f64 {
        let idle = !self.far.is_empty()
            && !self.tree.is_empty()
            && self.tree.importance(from, normal) <= 0.0;
        if idle { 0.0 } else { self.local_share }
    }

    /// A light at u in [0, 1), and the probability of its choice; see the table above.
    pub(super) fn choose(&self, from: DVec3, normal: DVec3, u: f64) -> Option<(u32, f64)> {
        let local = self.local_share(from, normal);
        if u < local {
            let (item, share, _) = self.tree.choose(from, normal, (u / local).min(BELOW_ONE))?;
            Some((*self.local.get(item as usize)?, local * share))
        } else {
            let rest = ((u - local) / (1.0 - local)).min(BELOW_ONE);
            let (index, _) = self.far_shares.choose(rest)?;
            let share = self.far_shares.probability(index);
            Some((*self.far.get(index)?, (1.0 - local) * share))
        }
    }

    /// The probability with which [`choose`](Self::choose) takes a light, to the bit.
    pub(super) fn probability(&self, light: u32, from: DVec3, normal: DVec3) -> f64 {
        match self.seats.get(light as usize) {
            None | Some(Seat::Dark) => 0.0,
            Some(Seat::Far(index)) => {
                (1.0 - self.local_share(from, normal))
                    * self.far_shares.probability(*index as usize)
            }
            Some(Seat::Local(item)) => {
                let local = self.local_share(from, normal);
                if local <= 0.0 {
                    return 0.0;
                }
                local * self.tree.probability(*item, from, normal)
            }
        }
    }
}
