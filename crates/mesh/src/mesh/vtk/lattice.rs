//! Points in rows, columns and layers, and the cells between them.

use super::piece::Piece;
use crate::error::{Error, ErrorKind, Result};

/// The largest number of points of a lattice whose points are not listed in the file one by one, and of voxels that are cells.
// A file of a few lines can ask for any number. So many points have 200 MB, and the corners of as many voxels 540 MB.
const MOST: usize = 1 << 23;

/// The keys of the coordinates along each axis in a file.
pub(super) const AXES: [&str; 3] = ["X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"];

/// How many points there are along each axis. An axis with one point is flat: cells between the points along the others are areas
/// or lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mesh) struct Lattice(pub [usize; 3]);

impl Lattice {
    /// The lattice of a file.
    ///
    /// # Errors
    /// An axis has no points, or there are more points than can be numbered.
    pub fn new(points: [u64; 3]) -> Result<Lattice> {
        let shown = || Error::expected("dimensions", "three counts of points above zero", format!("{points:?}"));
        // A count that cannot be numbered here is refused like none.
        let counts = points.map(|count| usize::try_from(count).unwrap_or(0));
        let all = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
        match all {
            Some(all) if all > 0 => Ok(Lattice(counts)),
            _ => Err(shown().of_kind(ErrorKind::Syntax)),
        }
    }

    pub fn point_count(&self) -> usize {
        self.0.iter().product()
    }

    /// The number of cells along each axis; 1 along a flat one.
    pub fn cells(&self) -> [usize; 3] {
        // Not zero, so that the product is the number of cells of the plane or line.
        self.0.map(|points| (points - 1).max(1))
    }

    pub fn cell_count(&self) -> usize {
        self.cells().iter().product()
    }

    /// The lattice whose cells have the points of this one as their middles.
    pub fn around_points(&self) -> Lattice {
        Lattice(self.0.map(|points| if points > 1 { points + 1 } else { 1 }))
    }

    /// The type of the cells in VTK: vertex, line, pixel or voxel.
    fn cell_type(&self) -> u8 {
        [1, 3, 8, 11][self.0.iter().filter(|points| **points > 1).count()]
    }

    /// The row, column and layer of a cell or point.
    pub fn place(counts: [usize; 3], index: usize) -> [usize; 3] {
        [index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]]
    }

    /// Whether a file has so many points.
    ///
    /// # Errors
    /// It has not.
    pub fn check_points(&self, found: usize) -> Result<()> {
        self.same("POINTS", self.point_count(), found)
    }

    /// Whether a file has so many coordinates along an axis.
    ///
    /// # Errors
    /// It has not.
    pub fn check_axis(&self, axis: usize, found: usize) -> Result<()> {
        self.same(AXES[axis], self.0[axis], found)
    }

    fn same(&self, key: &str, expected: usize, found: usize) -> Result<()> {
        match expected == found {
            true => Ok(()),
            false => {
                Err(Error::expected(key, format!("{expected} by the dimensions"), found).of_kind(ErrorKind::Syntax))
            }
        }
    }

    /// Fewer points than [`MOST`], for lattices that a short file can announce.
    ///
    /// # Errors
    /// There are more.
    pub fn limited(self) -> Result<Lattice> {
        match self.point_count() {
            count if count <= MOST => Ok(self),
            count => Err(too_many("points", count)),
        }
    }

    /// The cells that are kept, of points at the places that a function gives. Points without a cell are left out if `compact`.
    ///
    /// # Errors
    /// There are too many.
    pub fn piece(
        &self,
        kept: impl Fn(usize) -> bool,
        compact: bool,
        place: impl Fn([usize; 3]) -> [f64; 3],
    ) -> Result<Piece> {
        let (counts, cells) = (self.0, self.cells());
        let steps: Vec<[usize; 3]> = (0..8)
            .map(|corner| [corner & 1, corner >> 1 & 1, corner >> 2])
            .filter(|step| (0..3).all(|k| step[k] == 0 || counts[k] > 1))
            .collect();
        let mut piece = Piece::default();
        let mut numbers = vec![u64::MAX; if compact { self.point_count() } else { 0 }];
        if !compact {
            piece.points = (0..self.point_count()).map(|point| place(Lattice::place(counts, point))).collect();
        }
        for cell in (0..self.cell_count()).filter(|&cell| kept(cell)) {
            // Few cells of a large image may be kept, which is known only once they are counted.
            if piece.types.len() == MOST {
                return Err(too_many("cells", self.cell_count()));
            }
            let first = Lattice::place(cells, cell);
            for step in &steps {
                let at: [usize; 3] = std::array::from_fn(|k| first[k] + step[k]);
                let point = (at[2] * counts[1] + at[1]) * counts[0] + at[0];
                let number = match compact {
                    false => point as u64,
                    true => {
                        if numbers[point] == u64::MAX {
                            numbers[point] = piece.points.len() as u64;
                            piece.points.push(place(at));
                        }
                        numbers[point]
                    }
                };
                piece.connectivity.push(number);
            }
            piece.ends.push(piece.connectivity.len() as u64);
            piece.types.push(self.cell_type());
        }
        Ok(piece)
    }
}

fn too_many(what: &str, found: usize) -> Error {
    Error::new(format!("expected at most {MOST} {what}, found up to {found}: take a coarser image"))
        .of_kind(ErrorKind::Limit)
}
