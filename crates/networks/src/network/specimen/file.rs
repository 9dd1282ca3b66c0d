//! A network as a file holds it, and what is checked of all of them.

use crate::element::Element;
use crate::engine::Setting;
use crate::error::{Error, Result};
use crate::material::Plane;
use crate::mesh::Mesh;
use crate::model::Specimen;
use crate::network::model::mesh_of;
use crate::number::first_not_finite;
use nalgebra::DMatrix;
use std::path::PathBuf;
use std::sync::Arc;

/// A network as a file holds it.
#[derive(Debug)]
pub struct SpecimenFile {
    /// The network.
    pub specimen: Specimen,
    /// What the file is, in words.
    pub format: &'static str,
    /// The plane state and the thickness in m, where the file says them.
    pub state: Option<(Plane, f64)>,
    /// The settings of the engine for which the constants are, where the file says them.
    pub engine: Option<Setting>,
    /// What a reader must know of how the file was read, a sentence each.
    pub notes: Vec<String>,
}

/// What a file does not say of its network.
#[derive(Debug, Default)]
pub struct SpecimenOptions {
    /// A table of the points, for files without them.
    pub points: Option<PathBuf>,
    /// The vectors of the cell with which the network repeats itself, one in each row, m.
    pub cell: Option<DMatrix<f64>>,
    /// Whether a file with a box repeats itself in it; `None` lets the springs tell.
    pub is_periodic: Option<bool>,
    /// Elements of the cells that are not shipped.
    pub elements: Vec<Arc<Element>>,
}

impl SpecimenFile {
    /// A lattice by name.
    pub fn of_lattice(specimen: Specimen) -> SpecimenFile {
        // Formulas of plane lattices are those of a thickness of 1 m.
        let state = (specimen.network.dimension == 2).then_some((Plane::Stress, 1.0));
        SpecimenFile { state, ..SpecimenFile::plain(specimen, "a lattice by name") }
    }

    pub(super) fn plain(specimen: Specimen, format: &'static str) -> SpecimenFile {
        SpecimenFile { specimen, format, state: None, engine: None, notes: Vec::new() }
    }
}

impl SpecimenFile {
    /// That there are springs, all of them finite and between different places.
    pub(super) fn check(&self) -> Result<()> {
        let Specimen { network, points, masses, .. } = &self.specimen;
        let d = network.dimension;
        if network.is_empty() {
            return Err(Error::expected("springs", "at least one spring", "none"));
        }
        if let Some(at) = first_not_finite(points) {
            return Err(Error::expected(format!("points[{}]", at / d), "finite coordinates", points[at]));
        }
        for (s, spring) in network.lengths.iter().enumerate() {
            let key = |name: &str| format!("springs[{s}].{name}");
            if !spring.constant.is_finite() {
                return Err(Error::expected(key("constant"), "a finite number", spring.constant));
            }
            if !(spring.rest >= 0.0 && spring.rest.is_finite()) {
                return Err(Error::expected(key("rest"), "a length of at least zero", spring.rest));
            }
            let [a, b] = spring.points.map(|p| &points[p * d..(p + 1) * d]);
            if spring.rest > 0.0 && crate::springs::distance(a, b) == 0.0 {
                let found = format!("points {} and {} at one place", spring.points[0], spring.points[1]);
                return Err(Error::expected(key("points"), "two points at different places", found));
            }
        }
        if let Some(p) = masses.iter().flatten().position(|mass| !(*mass >= 0.0 && mass.is_finite())) {
            let found = masses.as_ref().map_or(f64::NAN, |masses| masses[p]);
            return Err(Error::expected(format!("masses[{p}]"), "a mass of at least zero, kg", found));
        }
        Ok(())
    }
}

/// The place of a point that a file counts from `first`.
pub(super) fn place(key: &str, number: i64, first: i64, count: usize) -> Result<usize> {
    let place = number.checked_sub(first).and_then(|place| usize::try_from(place).ok()).filter(|place| *place < count);
    place.ok_or_else(|| {
        let last = count as i64 + first - 1;
        let hint = if first == 0 && number == count as i64 { "; are points numbered from 1?" } else { "" };
        Error::expected(key, format!("a point from {first} to {last}"), number).followed_by(hint)
    })
}

/// The cells of a network of simplices, if a mesh of them has all points. Without one the network is measured all the same.
pub(super) fn simplex_mesh(points: &[f64], d: usize, nodes: Vec<usize>) -> Result<Option<Mesh>> {
    let element = Arc::new(Element::linear_simplex(d)?);
    Ok(mesh_of(d, points, vec![(element, nodes)]))
}
