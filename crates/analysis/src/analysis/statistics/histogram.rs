//! The distribution of many numbers over intervals.

/// Intervals of a histogram.
const INTERVALS: usize = 48;
/// The share of numbers at each end that may lie outside, where they lie far out: a single far number would leave the others one interval.
const OUTSIDE: f64 = 0.01;

/// A histogram counts how many numbers are in each of intervals of one width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// The numbers lie between these two, the least and the largest.
    pub range: [f64; 2],
    /// The first interval begins here.
    pub first: f64,
    /// Each interval has this width.
    pub width: f64,
    /// Each interval has so many numbers.
    pub counts: Vec<usize>,
    /// So many numbers are below the first interval, and above the last.
    pub outside: [usize; 2],
}

impl Histogram {
    /// Counts finite numbers; `None` if there are none.
    pub fn of(mut values: Vec<f64>) -> Option<Histogram> {
        values.sort_unstable_by(f64::total_cmp);
        let (least, largest) = (*values.first()?, *values.last()?);
        let skipped = (OUTSIDE * values.len() as f64) as usize;
        let inner = [values[skipped], values[values.len() - 1 - skipped]];
        let is_far = largest - least > 3.0 * (inner[1] - inner[0]);
        let [first, last] = if is_far && inner[0] < inner[1] { inner } else { [least, largest] };
        // Where nearly all are equal, an interval has a width all the same.
        let span = (last - first).max(1e-6 * first.abs().max(last.abs())).max(f64::MIN_POSITIVE);
        // The largest number belongs to the last interval, and not to one beyond.
        let width = span * (1.0 + 1e-9) / INTERVALS as f64;
        let mut counts = vec![0; INTERVALS];
        let mut outside = [0; 2];
        for value in values {
            match ((value - first) / width).floor() {
                place if place < 0.0 => outside[0] += 1,
                place if place >= INTERVALS as f64 => outside[1] += 1,
                place => counts[place as usize] += 1,
            }
        }
        Some(Histogram { range: [least, largest], first, width, counts, outside })
    }
}
