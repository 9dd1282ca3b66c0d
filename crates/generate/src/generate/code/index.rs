//! Places in arrays: integers that are known when the code is written, or follow from the variables of loops.

use std::ops::{Add, Mul, Sub};

/// `constant + Σ factor · atom`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Index {
    pub terms: Vec<(Atom, isize)>,
    pub constant: isize,
}

/// What an index depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Atom {
    /// The variable of a loop.
    Variable(usize),
    /// An entry of a table of integers: the table and the place in it.
    Entry(usize, Box<Index>),
}

impl Index {
    /// The variable of a loop.
    pub fn variable(variable: usize) -> Index {
        Index { terms: vec![(Atom::Variable(variable), 1)], constant: 0 }
    }

    /// The number, unless the index depends on loops.
    pub fn number(&self) -> Option<usize> {
        if self.terms.is_empty() { usize::try_from(self.constant).ok() } else { None }
    }
}

impl From<usize> for Index {
    fn from(number: usize) -> Index {
        Index { terms: Vec::new(), constant: number.cast_signed() }
    }
}

impl From<&Index> for Index {
    fn from(index: &Index) -> Index {
        index.clone()
    }
}

impl<I: Into<Index>> Add<I> for &Index {
    type Output = Index;

    fn add(self, other: I) -> Index {
        let (mut sum, other) = (self.clone(), other.into());
        sum.constant += other.constant;
        for (atom, factor) in other.terms {
            match sum.terms.iter_mut().find(|(known, _)| *known == atom) {
                Some((_, total)) => *total += factor,
                None => sum.terms.push((atom, factor)),
            }
        }
        sum.terms.retain(|(_, factor)| *factor != 0);
        sum
    }
}

impl<I: Into<Index>> Sub<I> for &Index {
    type Output = Index;

    fn sub(self, other: I) -> Index {
        let other: Index = other.into();
        let terms = other.terms.into_iter().map(|(atom, factor)| (atom, -factor)).collect();
        self + Index { terms, constant: -other.constant }
    }
}

impl Mul<usize> for &Index {
    type Output = Index;

    fn mul(self, factor: usize) -> Index {
        let factor = factor.cast_signed();
        let terms = self.terms.iter().map(|(atom, own)| (atom.clone(), own * factor));
        Index { terms: terms.filter(|(_, factor)| *factor != 0).collect(), constant: self.constant * factor }
    }
}
