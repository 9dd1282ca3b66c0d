//! The nodes of a file that numbers them, and their indices by number.

use std::collections::HashMap;

/// The indices of things by the numbers that a file gives them.
pub(super) enum Indices {
    /// The index of the thing with number `first + i` is at `i`; `ABSENT` for a number without one.
    Dense {
        first: u64,
        places: Vec<usize>,
    },
    Sparse(HashMap<u64, usize>),
}

/// Marks a number without a thing.
const ABSENT: usize = usize::MAX;

impl Indices {
    /// Indices in which the number `numbers[i]` has the index i.
    ///
    /// # Errors
    /// The number that occurs twice.
    pub fn of(numbers: &[u64]) -> std::result::Result<Indices, u64> {
        let first = numbers.iter().copied().min().unwrap_or(0);
        let span = numbers.iter().copied().max().unwrap_or(0) - first;
        let dense = usize::try_from(span).ok().filter(|&span| span / 4 <= numbers.len());
        if let Some(span) = dense {
            let mut places = vec![ABSENT; span + 1];
            for (i, &number) in numbers.iter().enumerate() {
                // `number - first` is at most `span`, which is a `usize`
                if std::mem::replace(&mut places[(number - first) as usize], i) != ABSENT {
                    return Err(number);
                }
            }
            return Ok(Indices::Dense { first, places });
        }
        let mut places = HashMap::with_capacity(numbers.len());
        for (i, &number) in numbers.iter().enumerate() {
            if places.insert(number, i).is_some() {
                return Err(number);
            }
        }
        Ok(Indices::Sparse(places))
    }

    /// The index of the thing with this number.
    pub fn index(&self, number: u64) -> Option<usize> {
        match self {
            Indices::Dense { first, places } => {
                let i = usize::try_from(number.checked_sub(*first)?).ok()?;
                places.get(i).copied().filter(|&place| place != ABSENT)
            }
            Indices::Sparse(places) => places.get(&number).copied(),
        }
    }

    /// The indices of the numbers from `first` to `last` in steps, as far as they are among `numbers`. The shorter of
    /// the two lists is walked; the second value is its length.
    pub fn in_range(&self, numbers: &[u64], [first, last, step]: [u64; 3]) -> (Vec<usize>, usize) {
        let Some(steps) = last.checked_sub(first).and_then(|span| span.checked_div(step)) else {
            return (Vec::new(), 0);
        };
        if steps < numbers.len() as u64 {
            return ((0..=steps).filter_map(|i| self.index(first + i * step)).collect(), steps as usize + 1);
        }
        let within = |n: u64| (first..=last).contains(&n) && (n - first).is_multiple_of(step);
        ((0..numbers.len()).filter(|&i| within(numbers[i])).collect(), numbers.len())
    }
}
