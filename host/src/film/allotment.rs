//! How many samples each pixel gets, where pixels differ in it.

use std::ops::Range;

use super::{Place, Window};

/// Samples for each pixel of a window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allotment {
    window: Window,
    /// Row-major.
    counts: Vec<u32>,
    /// The counts that occur, ascending, each with the number of pixels that have it or more.
    steps: Vec<(u32, u64)>,
}

impl Allotment {
    /// What a function gives the pixel of a column and row of the whole picture.
    pub fn new(window: Window, samples: impl Fn(u32, u32) -> u32) -> Self {
        let rows = window.y0..window.y1;
        let counts: Vec<u32> = rows
            .flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)))
            .map(|(x, y)| samples(x, y))
            .collect();
        let mut sorted = counts.clone();
        sorted.sort_unstable();
        let mut steps: Vec<(u32, u64)> = Vec::new();
        for (before, count) in sorted.iter().enumerate() {
            if steps.last().is_none_or(|(last, _)| last != count) {
                steps.push((*count, (sorted.len() - before) as u64));
            }
        }
        Self {
            window,
            counts,
            steps,
        }
    }

    /// The same for all pixels.
    pub fn uniform(window: Window, samples: u32) -> Self {
        Self::new(window, |_, _| samples)
    }

    /// The samples of a pixel; none outside of the window.
    pub fn samples(&self, x: u32, y: u32) -> u32 {
        if self.window.contains(x, y) {
            self.counts[self.window.index(x, y)]
        } else {
            0
        }
    }

    /// The samples of all pixels, row by row.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// The most that a pixel gets.
    pub fn largest(&self) -> u32 {
        self.steps.last().map_or(0, |(count, _)| *count)
    }

    /// The least that a pixel gets.
    pub fn smallest(&self) -> u32 {
        self.steps.first().map_or(0, |(count, _)| *count)
    }

    /// Samples of all pixels.
    pub fn total(&self) -> u64 {
        self.counts.iter().map(|&count| u64::from(count)).sum()
    }

    /// Samples per pixel.
    pub fn mean(&self) -> f64 {
        self.total() as f64 / self.counts.len().max(1) as f64
    }

    /// How many pixels get the sample of this index.
    pub fn pixels_with(&self, sample: u32) -> u64 {
        let beyond = self.steps.partition_point(|(count, _)| *count <= sample);
        self.steps.get(beyond).map_or(0, |(_, pixels)| *pixels)
    }
}

/// The samples of a tile's pixels that a pass traces, numbered pixel by pixel.
#[derive(Debug)]
pub struct Places {
    window: Window,
    samples: Range<u32>,
    /// Where pixels differ: for each the end of its samples, and the number of all samples before it, and of all.
    uneven: Option<(Vec<u32>, Vec<usize>)>,
}

impl Places {
    /// Of the pixels of `window` those of `samples` that an allotment, if there is one, grants.
    pub fn new(window: Window, samples: Range<u32>, allotment: Option<&Allotment>) -> Self {
        let rows = window.y0..window.y1;
        let pixels = rows.flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
        let uneven = allotment.map(|allotment| {
            let mut ends = Vec::with_capacity(window.pixels() as usize);
            let mut before = vec![0_usize];
            let mut all = 0;
            for (x, y) in pixels {
                let end = allotment.samples(x, y).clamp(samples.start, samples.end);
                ends.push(end);
                all += (end - samples.start) as usize;
                before.push(all);
            }
            (ends, before)
        });
        Self {
            window,
            samples,
            uneven,
        }
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        match &self.uneven {
            None => self.window.pixels() as usize * self.samples.len(),
            Some((_, before)) => before.last().copied().unwrap_or(0),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Column, row and samples of each pixel, in the order of numbers.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32, Range<u32>)> {
        let window = self.window;
        let rows = window.y0..window.y1;
        let pixels = rows.flat_map(move |y| (window.x0..window.x1).map(move |x| (x, y)));
        pixels.enumerate().map(|(index, (x, y))| {
            let uneven = self.uneven.as_ref().and_then(|(ends, _)| ends.get(index));
            let end = uneven.copied().unwrap_or(self.samples.end);
            (x, y, self.samples.start..end)
        })
    }

    /// The sample of a number below [`len`](Self::len).
    pub fn place(&self, number: usize) -> Place {
        let start = self.samples.start;
        let (pixel, sample, end) = match &self.uneven {
            None => {
                let per_pixel = self.samples.len().max(1);
                (number / per_pixel, number % per_pixel, self.samples.end)
            }
            Some((ends, before)) => {
                // The last pixel before which there are so many: pixels without samples are passed over.
                let pixel = before.partition_point(|&b| b <= number) - 1;
                (pixel, number - before[pixel], ends[pixel])
            }
        };
        let width = self.window.size()[0].max(1);
        Place {
            x: self.window.x0 + pixel as u32 % width,
            y: self.window.y0 + pixel as u32 / width,
            sample: start + sample as u32,
            samples: start..end,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window {
        x0: 2,
        y0: 1,
        x1: 7,
        y1: 4,
    };

    fn uneven(x: u32, y: u32) -> u32 {
        (x * 7 + y * 3) % 5
    }

    #[test]
    fn counts_are_counted() {
        let allotment = Allotment::new(WINDOW, uneven);
        let pixels = || (1..4).flat_map(|y| (2..7).map(move |x| (x, y)));
        for sample in 0..6 {
            let expected = pixels().filter(|&(x, y)| uneven(x, y) > sample).count();
            assert_eq!(allotment.pixels_with(sample), expected as u64, "{sample}");
        }
        assert_eq!((allotment.smallest(), allotment.largest()), (0, 4));
        let total: u32 = pixels().map(|(x, y)| uneven(x, y)).sum();
        assert_eq!(allotment.total(), u64::from(total));
        assert_eq!(allotment.samples(3, 2), uneven(3, 2));
        assert_eq!(allotment.samples(0, 0), 0);
        let same = Allotment::uniform(WINDOW, 9);
        assert_eq!((same.pixels_with(8), same.pixels_with(9)), (15, 0));
    }

    #[test]
    fn places_are_those_granted_each_once_and_in_order() {
        let allotment = Allotment::new(WINDOW, uneven);
        for samples in [0..4, 1..3, 2..9, 4..5] {
            for granted in [None, Some(&allotment)] {
                let places = Places::new(WINDOW, samples.clone(), granted);
                let mut expected = Vec::new();
                for (y, x) in (1..4).flat_map(|y| (2..7).map(move |x| (y, x))) {
                    let end = granted.map_or(samples.end, |a| a.samples(x, y).min(samples.end));
                    expected.extend((samples.start..end).map(|sample| Place {
                        x,
                        y,
                        sample,
                        samples: samples.start..end,
                    }));
                }
                let found: Vec<_> = (0..places.len()).map(|n| places.place(n)).collect();
                assert_eq!(found, expected);
                assert_eq!(places.is_empty(), expected.is_empty());
            }
        }
    }
}
