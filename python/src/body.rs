//! What a network of Python is made of: a fit with all that belongs to it, or springs that were given.

use springfit::error::{Error, Result};
use springfit::material::CellMap;
use springfit::mesh::{Mesh, Selection};
use springfit::model::{
    self, Action, BlockStiffness, CompressedRows, Deformation, Elastic, Support, nodal_forces, unheld_bodies,
    unheld_parts,
};
use springfit::report::NetworkFile;
use springfit::study::{FitOutcome, Outcome};
use std::sync::Arc;

/// The springs with their points, and what is known beside them. Copies share it.
#[derive(Clone)]
pub enum Body {
    /// By a fit of the finite elements.
    Fitted(Arc<Outcome>),
    /// From arrays or a file.
    Given(Arc<GivenBody>),
}

/// Springs from arrays or a file.
pub struct GivenBody {
    /// The points; without cells where none are known.
    pub mesh: Arc<Mesh>,
    /// The springs.
    pub network: model::Network,
    /// `[points]`, kg.
    pub masses: Option<Vec<f64>>,
}

impl Body {
    pub fn mesh(&self) -> &Mesh {
        match self {
            Body::Fitted(outcome) => &outcome.mesh,
            Body::Given(given) => &given.mesh,
        }
    }

    pub fn network(&self) -> &model::Network {
        match self {
            Body::Fitted(outcome) => &outcome.fits[0].network,
            Body::Given(given) => &given.network,
        }
    }

    pub fn masses(&self) -> Option<&[f64]> {
        match self {
            Body::Fitted(outcome) => outcome.masses.as_deref(),
            Body::Given(given) => given.masses.as_deref(),
        }
    }

    /// The fit that made it, if there is one.
    pub fn fit(&self) -> Option<(&Outcome, &FitOutcome)> {
        match self {
            Body::Fitted(outcome) => Some((outcome, &outcome.fits[0])),
            Body::Given(_) => None,
        }
    }

    pub fn file(&self) -> NetworkFile<'_> {
        match self {
            Body::Fitted(outcome) => NetworkFile::of(outcome, &outcome.fits[0]),
            Body::Given(given) => NetworkFile::with_masses(&given.mesh, &given.network, given.masses.as_deref()),
        }
    }

    /// The positions at rest, `[points × dimension]`, m.
    pub fn points(&self) -> &[f64] {
        &self.mesh().points
    }

    pub fn dimension(&self) -> usize {
        self.mesh().dimension
    }

    /// The numbers of points and of their coordinates.
    pub fn shape(&self) -> [usize; 2] {
        [self.mesh().point_count(), self.dimension()]
    }

    /// Whether cells are known.
    pub fn has_cells(&self) -> bool {
        !self.mesh().blocks.is_empty()
    }

    /// Whether the support leaves no connected part free to move as it is.
    pub fn is_held(&self, support: &Support) -> bool {
        match self.has_cells() {
            true => unheld_bodies(self.mesh(), support).is_empty(),
            false => unheld_parts(self.network(), self.points(), support).is_empty(),
        }
    }

    /// How far displacements u deform it, `[points · dimension]`, m: at the quadrature points of its cells, or along its springs.
    pub fn deformation(&self, u: &[f64]) -> Deformation {
        match self.has_cells() {
            true => Deformation::largest(self.mesh(), u),
            false => Deformation::of_springs(self.network(), self.points(), u),
        }
    }

    /// The tangent stiffness at positions x, row by row; at rest if there are none. Functions of Python are called on this thread alone,
    /// `has_functions` says whether there are some.
    ///
    /// # Errors
    /// The springs have no tangent there.
    pub fn stiffness(&self, x: Option<&[f64]>, has_functions: bool) -> Result<CompressedRows> {
        let (network, [points, d]) = (self.network(), self.shape());
        let rows = match x {
            _ if d > 1 && points < u32::MAX as usize && !has_functions => {
                BlockStiffness::of_network(network, x.unwrap_or(self.points()), None).rows()
            }
            None => CompressedRows::of_lower(points * d, &network.stiffness(self.points())),
            Some(x) => {
                let found = network.respond(x).ok_or_else(|| undefined("a tangent"))?;
                CompressedRows::of_lower(points * d, &found.tangent)
            }
        };
        match rows.values.iter().all(|value| value.is_finite()) {
            true => Ok(rows),
            false => Err(undefined("a tangent")),
        }
    }

    /// A total force on a group of the mesh as nodal forces, shared as that of a load of a scene.
    ///
    /// # Errors
    /// The mesh has no such group, or the force does not act on it.
    pub fn group_forces(&self, group: &str, force: Vec<f64>) -> Result<Vec<f64>> {
        let thickness = match self {
            Body::Fitted(outcome) => outcome.material.thicknesses(),
            Body::Given(_) => CellMap::Uniform(1.0),
        };
        nodal_forces(self.mesh(), &Selection::Group(group.into()), &Action::Force(force), thickness)
    }
}

/// The error of positions where the springs have no energy or a derivative of it.
pub fn undefined(what: &str) -> Error {
    Error::expected("x", format!("positions where the springs have {what}"), "others")
}
