//! A network on its points, whoever made it, with what is known of it beside its springs.

use super::network::Network;
use super::support::Support;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::{Gate, Mesh, MeshArrays};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Images at distances that differ by less than this share are at the same distance.
// Points and cells are rounded to 1.1e-16 of their distance from the origin: up to 1e6 lengths of a spring the bound is above that.
// A larger difference is in the file itself: its author meant two distances.
const SAME: f64 = 1e-9;

/// A network on its points.
#[derive(Debug, Clone)]
pub struct Specimen {
    /// The springs.
    pub network: Network,
    /// The positions, `[points × dimension]`, m. In a periodic network those of images follow its own.
    pub points: Vec<f64>,
    /// The masses of its own points, kg.
    pub masses: Option<Vec<f64>>,
    /// The cells on the same points, if there are any.
    pub mesh: Option<Mesh>,
    /// How the network repeats itself, if it does.
    pub period: Option<Period>,
    /// What is held, if anything is.
    pub support: Option<Support>,
    /// Nodal forces of loads, `[points · dimension]`, N.
    pub loads: Vec<Vec<f64>>,
}

/// How a network repeats itself in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Period {
    /// The vectors of the cell, one in each row, `[dimension × dimension]`, m.
    pub cell: DMatrix<f64>,
    /// The own point of which each point is an image, `[points with images]`; own points come first.
    pub owners: Vec<usize>,
}

impl Specimen {
    /// A network without anything beside its springs.
    pub fn new(network: Network, points: Vec<f64>) -> Specimen {
        Specimen { network, points, masses: None, mesh: None, period: None, support: None, loads: Vec::new() }
    }

    /// The number of its own points.
    pub fn count(&self) -> usize {
        match &self.period {
            // Images stand behind the points that they repeat.
            Some(period) => period.owners.iter().enumerate().take_while(|(p, owner)| p == *owner).count(),
            None => self.points.len() / self.network.dimension.max(1),
        }
    }

    /// The own point of a point.
    pub fn owner(&self, point: usize) -> usize {
        self.period.as_ref().map_or(point, |period| period.owners[point])
    }

    /// A mesh on the points whose cells are the springs on lengths, for files of networks that have no cells.
    ///
    /// # Errors
    /// A point has no spring, or a spring no length.
    pub fn bars(&self) -> Result<Mesh> {
        let element = Arc::new(Element::linear_simplex(1)?);
        let ends = self.network.lengths.iter().flat_map(|spring| spring.points).collect();
        let given = MeshArrays {
            dimension: self.network.dimension,
            points: self.points.clone(),
            blocks: vec![(element, ends)],
            groups: BTreeMap::new(),
            cell_groups: BTreeMap::new(),
        };
        let mesh = given.build(Gate::default())?;
        match mesh.points == self.points {
            true => Ok(mesh),
            false => {
                let expected = "a spring at each point, as files of networks have them";
                Err(Error::expected("springs", expected, "points without one").of_kind(ErrorKind::Unsupported))
            }
        }
    }

    /// The network repeats itself with the vectors of `cell`, one in each row. Each spring joins its first point with the nearest images of
    /// the others. Masses and forces stay those of the own points; cells and supports are left out.
    ///
    /// # Errors
    /// The vectors span nothing; or two images of a point are equally near, so that it is not known which is meant.
    pub fn repeated(self, cell: DMatrix<f64>) -> Result<Specimen> {
        let d = self.network.dimension;
        let volume = if cell.nrows() == d && cell.ncols() == d { cell.determinant() } else { 0.0 };
        let inverse = cell.clone().try_inverse().filter(|_| volume != 0.0 && volume.is_finite());
        let Some(inverse) = inverse else {
            let expected = format!("{d} vectors of {d} coordinates that span a cell");
            let rows: Vec<String> =
                cell.row_iter().map(|row| format!("{:?}", row.iter().collect::<Vec<_>>())).collect();
            return Err(Error::expected("cell", expected, rows.join(", ")));
        };
        let Specimen { mut network, points, masses, .. } = self;
        let mut images =
            Images { cell: &cell, inverse, d, owners: (0..points.len() / d).collect(), points, known: HashMap::new() };
        for (s, spring) in network.lengths.iter_mut().enumerate() {
            let [i, j] = spring.points;
            let near = images.near(i, j).map_err(|e| e.under(format!("springs[{s}]")))?;
            spring.points = [i.min(near), i.max(near)];
        }
        let lengths = network.lengths.len();
        for (s, spring) in network.others.iter_mut().enumerate() {
            let first = spring.points[0];
            for place in 1..spring.points.len() {
                let near = images.near(first, spring.points[place]);
                spring.points[place] = near.map_err(|e| e.under(format!("springs[{}]", lengths + s)))?;
            }
        }
        let Images { points, owners, .. } = images;
        let period = Some(Period { cell, owners });
        Ok(Specimen { masses, period, ..Specimen::new(network, points) })
    }
}

/// The points with the images that springs reach.
struct Images<'a> {
    cell: &'a DMatrix<f64>,
    inverse: DMatrix<f64>,
    d: usize,
    points: Vec<f64>,
    owners: Vec<usize>,
    known: HashMap<(usize, Vec<i64>), usize>,
}

impl Images<'_> {
    /// The image of point j nearest to point i.
    fn near(&mut self, i: usize, j: usize) -> Result<usize> {
        let d = self.d;
        let between = DVector::from_fn(d, |k, _| self.points[j * d + k] - self.points[i * d + k]);
        // x = nᵀ cell, so that n = x cell⁻¹; in skewed cells the nearest image may be one beside.
        let rounded: Vec<i64> = (self.inverse.transpose() * &between).iter().map(|n| -n.round() as i64).collect();
        let (mut nearest, mut second) = ((f64::INFINITY, rounded.clone()), f64::INFINITY);
        // All 3^d cells around the rounded one, each by its digits in base three.
        for step in 0..3usize.pow(d as u32) {
            let shift: Vec<i64> = (0..d).map(|k| rounded[k] + (step / 3usize.pow(k as u32) % 3) as i64 - 1).collect();
            // A spring from a point to itself goes to an image of it.
            if i == j && shift.iter().all(|n| *n == 0) {
                continue;
            }
            let distance = (&between + self.translation(&shift)).norm();
            if distance < nearest.0 {
                second = nearest.0;
                nearest = (distance, shift);
            } else {
                second = second.min(distance);
            }
        }
        if !(nearest.0 > SAME * second) {
            let expected = "springs between points at different places";
            let found = format!("point {j} and an image of point {i} at one place");
            return Err(Error::expected("cell", expected, found));
        }
        if second - nearest.0 <= SAME * second {
            let expected = "a cell more than twice as long as its springs: with a multiple of the cell it is clear which image is meant";
            let found = format!("two images of point {j} at {:.6e} m from point {i}", nearest.0);
            return Err(Error::expected("cell", expected, found).of_kind(ErrorKind::Unsupported));
        }
        Ok(self.image(j, nearest.1))
    }

    fn translation(&self, shift: &[i64]) -> DVector<f64> {
        let numbers = DVector::from_iterator(self.d, shift.iter().map(|n| *n as f64));
        self.cell.transpose() * numbers
    }

    fn image(&mut self, point: usize, shift: Vec<i64>) -> usize {
        if shift.iter().all(|n| *n == 0) {
            return point;
        }
        let d = self.d;
        let offset = self.translation(&shift);
        let next = self.owners.len();
        let place = *self.known.entry((point, shift)).or_insert(next);
        if place == next {
            self.owners.push(point);
            (0..d).for_each(|k| self.points.push(self.points[point * d + k] + offset[k]));
        }
        place
    }
}
