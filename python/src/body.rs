//! What a network of Python is made of: a fit with all that belongs to it, or springs that were given.

use crate::ends::Ends;
use crate::error::{invalid, raised};
use crate::progress::{alone, apart};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springfit_bodies::model::{
    self, Action, BlockStiffness, CompressedRows, Deformation, Elastic, Support, nodal_forces, unheld_bodies,
    unheld_parts,
};
use springfit_element::material::CellMap;
use springfit_foundation::error::{Error, Result};
use springfit_mesh::mesh::{Mesh, Selection};
use springfit_report::report::{NetworkFacts, NetworkFile};
use springfit_studies::study::{FitOutcome, Outcome};
use std::sync::Arc;

/// The springs with their points, and what is known beside them. Copies share it.
#[derive(Clone)]
pub struct Body {
    source: Source,
    /// Whether laws of force call functions of Python.
    pub has_functions: bool,
}

#[derive(Clone)]
enum Source {
    /// A fit of the finite elements made it.
    Fitted(Arc<Outcome>),
    /// Arrays or a file gave it.
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
    /// What is known beside them.
    pub facts: NetworkFacts,
}

impl Body {
    /// The body of the one fit of an outcome.
    pub fn fitted(outcome: Outcome, has_functions: bool) -> Body {
        Body { source: Source::Fitted(Arc::new(outcome)), has_functions }
    }

    pub fn given(given: GivenBody, has_functions: bool) -> Body {
        Body { source: Source::Given(Arc::new(given)), has_functions }
    }

    /// These springs on the same points.
    pub fn with_network(&self, network: model::Network) -> Body {
        let mesh = match &self.source {
            Source::Fitted(outcome) => Arc::new(outcome.mesh.clone()),
            Source::Given(given) => given.mesh.clone(),
        };
        let masses = self.masses().map(<[f64]>::to_vec);
        let facts = self.file().facts();
        Body::given(GivenBody { mesh, network, masses, facts }, self.has_functions)
    }

    /// Evaluates the springs, whose functions may raise exceptions; a function of Python hears signals itself.
    pub fn evaluated<T: Send>(&self, py: Python, evaluate: impl FnOnce() -> Result<T> + Send) -> PyResult<T> {
        let ends = Arc::new(Ends::default());
        let result = apart(py, || ends.during(evaluate));
        ends.check(py)?;
        result.map_err(|error| raised(py, error))
    }

    /// As [`Body::evaluated`] where functions of Python are called, otherwise on a thread of its own, which a signal ends.
    pub fn worked<T: Send + 'static>(
        &self,
        py: Python,
        work: impl FnOnce(&Body) -> Result<T> + Send + 'static,
    ) -> PyResult<T> {
        let body = self.clone();
        if self.has_functions { self.evaluated(py, move || work(&body)) } else { alone(py, move || work(&body)) }
    }

    /// The support of these components at rest.
    pub fn support(&self, py: Python, held: &PyReadonlyArray2<bool>) -> PyResult<Support> {
        let shape = self.shape();
        if held.shape() != shape {
            return Err(invalid(py, "fix", &format!("an array of shape {shape:?}"), format!("{:?}", held.shape())));
        }
        Ok(Support { prescribed: held.as_array().iter().map(|held| held.then_some(0.0)).collect() })
    }

    pub fn mesh(&self) -> &Mesh {
        match &self.source {
            Source::Fitted(outcome) => &outcome.mesh,
            Source::Given(given) => &given.mesh,
        }
    }

    pub fn network(&self) -> &model::Network {
        match &self.source {
            Source::Fitted(outcome) => &outcome.fits[0].network,
            Source::Given(given) => &given.network,
        }
    }

    pub fn masses(&self) -> Option<&[f64]> {
        match &self.source {
            Source::Fitted(outcome) => NetworkFile::of(outcome, &outcome.fits[0]).masses(),
            Source::Given(given) => given.masses.as_deref(),
        }
    }

    /// The fit that made it, if there is one.
    pub fn fit(&self) -> Option<(&Outcome, &FitOutcome)> {
        match &self.source {
            Source::Fitted(outcome) => Some((outcome, &outcome.fits[0])),
            Source::Given(_) => None,
        }
    }

    pub fn file(&self) -> NetworkFile<'_> {
        match &self.source {
            Source::Fitted(outcome) => NetworkFile::of(outcome, &outcome.fits[0]),
            Source::Given(given) => {
                NetworkFile::with_masses(&given.mesh, &given.network, given.masses.as_deref()).knowing(&given.facts)
            }
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

    /// The tangent stiffness at positions x, row by row; at rest if there are none. Functions of Python are called on this thread alone.
    ///
    /// # Errors
    /// The springs have no tangent there.
    pub fn stiffness(&self, x: Option<&[f64]>) -> Result<CompressedRows> {
        let (network, [points, d]) = (self.network(), self.shape());
        let rows = match x {
            _ if d > 1 && points < u32::MAX as usize && !self.has_functions => {
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
        let thickness = match &self.source {
            Source::Fitted(outcome) => outcome.material.thicknesses(),
            Source::Given(_) => CellMap::Uniform(1.0),
        };
        nodal_forces(self.mesh(), &Selection::Group(group.into()), &Action::Force(force), thickness)
    }
}

/// The error of positions where the springs have no energy or a derivative of it.
pub fn undefined(what: &str) -> Error {
    Error::expected("x", format!("positions where the springs have {what}"), "others")
}
