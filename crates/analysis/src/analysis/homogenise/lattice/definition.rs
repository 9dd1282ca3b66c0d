//! What a lattice is: points in a cell, and bonds from a point to an image of a point. All bonds of one shell have the same length and
//! constant, and do not pull at rest.

use crate::error::{Error, Result};
use crate::model::{LengthSpring, Network, Period, Specimen};
use nalgebra::DMatrix;
use std::collections::HashMap;

/// A bond of a lattice: from a point of the cell to a point of the cell that is shifted by so many of its vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bond {
    /// It begins at this point.
    pub from: usize,
    /// It ends at this point.
    pub to: usize,
    /// The cell of its end.
    pub shift: [i64; 3],
    /// Its constant is that of this shell, from 0.
    pub shell: usize,
}

/// A lattice of springs.
#[derive(Debug)]
pub struct NamedLattice {
    /// Its name.
    pub name: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// The shells of bonds by name, such as edges.
    pub shells: &'static [&'static str],
    /// The square of what the coordinates along y are multiplied by: 1, or 3.
    pub root: Root,
    /// Twelve times the vectors of the cell in units of the spacing, a row each; y without its root.
    pub(super) cell: &'static [[i64; 3]],
    /// Twelve times the coordinates of the points, as those of the vectors.
    pub(super) points: &'static [[i64; 3]],
    /// The squared length of the bonds of each shell, twelve times twelve times, in units of the squared spacing.
    pub(super) squares: &'static [i64],
}

/// What the coordinates of a lattice along y are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Root {
    /// They are rational.
    #[default]
    One,
    /// They are rational numbers times √3.
    OfThree,
}

impl Root {
    pub(super) fn square(self) -> i64 {
        match self {
            Root::One => 1,
            Root::OfThree => 3,
        }
    }
}

/// The denominator of all coordinates.
// It is the least common multiple of the halves, thirds, quarters and sixths in which lattices have their points: whole numbers
// then find the bonds of a shell by equal squares, without a tolerance.
pub(super) const UNIT: i64 = 12;
/// Bonds reach at most so many cells.
// The bonds of all lattices of the table end in the next cell. A row with a more oblique cell may need one cell more, and a
// search among 5³ cells takes no time.
const REACH: i64 = 2;

impl NamedLattice {
    /// The number of coordinates.
    pub fn dimension(&self) -> usize {
        self.cell.len()
    }

    /// The number of points in a cell.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// `x` of a point of a shifted cell, twelve times.
    fn place(&self, point: usize, shift: [i64; 3]) -> [i64; 3] {
        let mut x = self.points[point];
        for (row, n) in self.cell.iter().zip(shift) {
            (0..3).for_each(|k| x[k] += n * row[k]);
        }
        x
    }

    /// The vector from the beginning to the end of a bond, twelve times.
    pub(super) fn along(&self, bond: &Bond) -> [i64; 3] {
        let (from, to) = (self.points[bond.from], self.place(bond.to, bond.shift));
        std::array::from_fn(|k| to[k] - from[k])
    }

    /// The bonds of a cell, each once.
    pub fn bonds(&self) -> Vec<Bond> {
        let d = self.dimension();
        let count = 2 * REACH + 1;
        let mut bonds = Vec::new();
        for step in 0..count.pow(d as u32) {
            let shift: [i64; 3] =
                std::array::from_fn(|k| if k < d { step / count.pow(k as u32) % count - REACH } else { 0 });
            for (from, to) in (0..self.points.len()).flat_map(|a| (0..self.points.len()).map(move |b| (a, b))) {
                // Of a bond and its reverse the one that leads on in the order of points, then of cells, is kept.
                if (to, shift) <= (from, [0; 3]) {
                    continue;
                }
                let bond = Bond { from, to, shift, shell: 0 };
                let [x, y, z] = self.along(&bond);
                let square = x * x + self.root.square() * y * y + z * z;
                // Squares of distances are whole numbers, also with √3 along y, so that they are compared exactly.
                let shell = self.squares.iter().position(|own| *own == square);
                bonds.extend(shell.map(|shell| Bond { shell, ..bond }));
            }
        }
        bonds
    }

    /// Metres of a coordinate that is twelve times in units of the spacing.
    fn metres(&self, value: i64, axis: usize, spacing: f64) -> f64 {
        let scale = if axis == 1 && self.root == Root::OfThree { 3f64.sqrt() } else { 1.0 };
        value as f64 * scale * spacing / UNIT as f64
    }

    /// The lattice with this spacing a, m, and the constants of its shells, N/m; missing ones are zero.
    ///
    /// # Errors
    /// The spacing is not above zero, there are more constants than shells, or a constant is not finite.
    pub fn specimen(&self, spacing: f64, constants: &[f64]) -> Result<Specimen> {
        self.check(spacing, constants)?;
        let d = self.dimension();
        let metres = |x: [i64; 3]| (0..d).map(move |k| self.metres(x[k], k, spacing)).collect::<Vec<f64>>();
        let mut points: Vec<f64> = (0..self.points.len()).flat_map(|p| metres(self.place(p, [0; 3]))).collect();
        let mut owners: Vec<usize> = (0..self.points.len()).collect();
        let mut images: HashMap<(usize, [i64; 3]), usize> = owners.iter().map(|&p| ((p, [0; 3]), p)).collect();
        let mut network = Network { dimension: d, ..Network::default() };
        for bond in self.bonds() {
            let constant = constants.get(bond.shell).copied().unwrap_or(0.0);
            // A shell without a spring would only add images that nothing holds.
            if constant == 0.0 {
                continue;
            }
            let next = owners.len();
            let end = *images.entry((bond.to, bond.shift)).or_insert(next);
            if end == next {
                owners.push(bond.to);
                points.extend(metres(self.place(bond.to, bond.shift)));
            }
            let rest = (self.squares[bond.shell] as f64).sqrt() * spacing / UNIT as f64;
            network.lengths.push(LengthSpring { points: [bond.from.min(end), bond.from.max(end)], constant, rest });
        }
        let cell = self.vectors(spacing);
        Ok(Specimen { period: Some(Period { cell, owners }), ..Specimen::new(network, points) })
    }

    /// The vectors of the cell with which it repeats itself, one in each row, m.
    fn vectors(&self, spacing: f64) -> DMatrix<f64> {
        let d = self.dimension();
        DMatrix::from_fn(d, d, |row, k| self.metres(self.cell[row][k], k, spacing))
    }

    /// The volume of that cell, m³; in the plane its area, m².
    pub fn content(&self, spacing: f64) -> f64 {
        self.vectors(spacing).determinant().abs()
    }

    /// A piece of the lattice: so many cells along each of its vectors, with all bonds whose ends it has.
    ///
    /// # Errors
    /// Those of [`NamedLattice::specimen`]; or there is not a count above zero for each vector.
    pub fn piece(&self, spacing: f64, constants: &[f64], cells: &[usize]) -> Result<Specimen> {
        self.check(spacing, constants)?;
        let d = self.dimension();
        // The product of given counts may be beyond the machine's numbers.
        let total = cells.iter().try_fold(self.points.len(), |product, n| product.checked_mul(*n));
        let is_sound = cells.len() == d && cells.iter().all(|n| *n > 0);
        let Some(_) = total.filter(|total| is_sound && *total <= MOST) else {
            let expected = format!("{d} whole numbers above zero, of at most {MOST} points together");
            return Err(Error::expected("cells", expected, format!("{cells:?}")));
        };
        let number = |shift: [i64; 3]| {
            let inside = (0..d).all(|k| shift[k] >= 0 && (shift[k] as usize) < cells[k]);
            // The first direction runs fastest, as it does in the list of shifts below.
            inside.then(|| (0..d).rev().fold(0, |sum, k| sum * cells[k] + shift[k] as usize))
        };
        let shifts: Vec<[i64; 3]> = (0..cells.iter().product::<usize>())
            .map(|step| {
                let mut rest = step;
                std::array::from_fn(|k| {
                    let n = cells.get(k).map_or(0, |count| rest % count);
                    rest /= cells.get(k).copied().unwrap_or(1);
                    n as i64
                })
            })
            .collect();
        let mut points = Vec::new();
        let mut network = Network { dimension: d, ..Network::default() };
        let bonds = self.bonds();
        for shift in &shifts {
            for p in 0..self.points.len() {
                let x = self.place(p, *shift);
                points.extend((0..d).map(|k| self.metres(x[k], k, spacing)));
            }
            let own = number(*shift).expect("it is one of the cells");
            for bond in &bonds {
                let constant = constants.get(bond.shell).copied().unwrap_or(0.0);
                let other = number(std::array::from_fn(|k| shift[k] + bond.shift[k]));
                if let Some(other) = other.filter(|_| constant != 0.0) {
                    let (from, to) = (own * self.points.len() + bond.from, other * self.points.len() + bond.to);
                    let rest = (self.squares[bond.shell] as f64).sqrt() * spacing / UNIT as f64;
                    network.lengths.push(LengthSpring { points: [from.min(to), from.max(to)], constant, rest });
                }
            }
        }
        network.lengths.sort_by_key(|spring| spring.points);
        Ok(Specimen::new(network, points))
    }

    fn check(&self, spacing: f64, constants: &[f64]) -> Result<()> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(Error::expected("spacing", "a length above zero, m", spacing));
        }
        let shells = self.shells.join(", ");
        if constants.is_empty() || constants.len() > self.shells.len() {
            let expected = format!("at most {} constants, of {shells}", self.shells.len());
            return Err(Error::expected("constants", expected, constants.len()));
        }
        match constants.iter().find(|k| !k.is_finite()) {
            Some(k) => Err(Error::expected("constants", "finite numbers, N/m", k)),
            None => Ok(()),
        }
    }
}

/// Points of a piece at most.
// With up to 13 springs of 32 bytes for each point (`cubic`) their network has 4 GB.
const MOST: usize = 10_000_000;
