//! The two models of one mesh, finite elements and springs, both with a sparse stiffness on the same degrees of
//! freedom.
//!
//! Supports, loads and masses are common to both, so that they can be compared. The degree of freedom of a point in a
//! direction has the number `point · dimension + direction`.
//!
//! Theory: pages *Stiffness and the reduced space* and *Exact networks and patches* of the book.

mod assembly;
mod bending;
mod blocks;
mod cavity;
mod component;
mod consistent;
mod deformation;
mod domains;
mod elastic;
mod exact;
mod fibres;
mod flexure;
mod forces;
mod functions;
mod gradients;
mod integration;
mod linear;
mod load;
mod lumping;
mod material_points;
mod means;
mod moments;
mod network;
mod numbering;
mod parts;
mod patches;
mod plate;
mod prepared;
mod pressed;
mod pressure;
mod recovery;
mod relaxation;
mod rod;
mod rod_load;
mod rows;
mod sensitivity;
mod shares;
mod simplices;
mod size;
mod specimen;
mod steady;
mod strains;
mod support;
mod system;
mod tension;

pub use bending::{BendingSprings, bending_springs};
pub use blocks::{BlockStiffness, CompressedRows};
pub use cavity::Cavity;
pub use component::Component;
pub use consistent::ConsistentMasses;
pub use deformation::Deformation;
pub use domains::{EdgeDomain, edge_domains, network_of, parts as domain_parts};
pub use domains::{edge_springs, has_edge_springs};
pub use elastic::{Body, Elastic, inverted};
pub use exact::exact_network;
pub use fibres::{fibre_springs, fibre_springs_of_regions};
pub use flexure::{hinge_flexure, is_flat};
pub use gradients::SpringGradients;
pub use linear::LinearElastic;
pub use load::{Action, Traction, boundary_forces, nodal_forces, point_contents};
pub use lumping::{Lumping, lumped_masses, masses};
pub use material_points::{MaterialPoint, MaterialPoints};
pub use means::cell_means;
pub use moments::Moments;
pub use network::{LengthSpring, MeasureSpring, Network, SpringLaw};
pub use numbering::dofs;
pub(crate) use numbering::places;
pub use parts::{PartVectors, Places};
pub use patches::patch_springs;
pub(crate) use prepared::{BranchRule, Branches, origin};
pub use prepared::{Precision, PreparedNetwork};
pub use pressed::PressedFaces;
pub use pressure::smoothed_pressure;
pub use recovery::lacking_energy;
pub use relaxation::{PatchSpring, relaxed_stiffness, stiffness_product};
pub use rows::{RowForces, Rows};
pub use sensitivity::NetworkNumbers;
pub use shares::{LengthShare, SharedSpring, is_exact, length_shares};
pub use size::ADVICE;
pub use size::check_body;
pub use specimen::{Period, Specimen};
pub use strains::has_strains;
pub use support::{Support, Unheld, unheld_bodies, unheld_parts};
pub use system::{cell_places, content, each_cell_forces, finite_elements};
pub use tension::{RestTension, is_balanced};

use faer::sparse::Triplet;

/// Entries of the lower triangle of a symmetric matrix; entries at the same position are added.
pub type Entries = Vec<Triplet<usize, usize, f64>>;

/// The positions `x = X + u`, `[points · dimension]`, m.
pub fn displaced(points: &[f64], u: &[f64]) -> Vec<f64> {
    points.iter().zip(u).map(|(x, u)| x + u).collect()
}

/// Energy, forces and tangent of a model at given positions.
#[derive(Debug, Clone)]
pub struct Response {
    /// The energy, J.
    pub energy: f64,
    /// The gradient of the energy in the positions, `[points · dimension]`, N.
    pub force: Vec<f64>,
    /// The second derivative of the energy, N/m.
    pub tangent: Entries,
}
