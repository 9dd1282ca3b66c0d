//! Meshes of known elements: points, cells and named groups, in metres.
//!
//! [`MeshSource`] is what a file says; [`Mesh::resolve`] gives its cells their elements and checks them. [`BoxMesh`]
//! and [`DiscMesh`] generate meshes.

mod abaqus;
mod affine;
mod alike;
mod annotations;
mod arrays;
mod attached;
mod boxes;
mod carrier;
mod coincident;
mod connection;
mod content;
mod couples;
mod directors;
mod disc;
mod disjoint;
mod duplicates;
mod embedding;
mod facets;
mod field;
mod fill;
mod folds;
mod formats;
mod frame;
pub mod gmsh;
mod grouping;
mod hanging;
mod idle;
mod include;
mod indices;
mod inspection;
mod joints;
mod lines;
mod listing;
#[allow(clippy::module_inception)]
mod mesh;
mod nastran;
mod numbering;
mod numpy;
mod outside;
mod overlaps;
mod places;
mod polygons;
mod polytope;
mod quality;
mod range;
mod reader;
mod reading;
mod refinement;
mod resolution;
mod selection;
mod source;
mod surface;
mod surfaces;
mod tetgen;
mod voxels;
pub mod vtk;

pub use annotations::{Annotations, Section};
pub use arrays::MeshArrays;
pub use boxes::BoxMesh;
pub use carrier::Carrier;
pub use connection::pieces_of;
pub use disc::DiscMesh;
pub use embedding::Embedding;
pub use field::{Accepted, Field, Holder, Interpolation, NamedState, SampleReading, Samples, Scattered};
pub use fill::{FaceCrossings, FillBoundary, FillLayers, FillMesh, FillSpacing, Filled, Fragments, Repair};
pub use formats::{MESH_FORMATS, MeshFormat, listed_endings};
pub use mesh::{CellBlock, CellIndex, Chosen, Directors, Group, Mesh, SideIndex};
pub use numbering::{NumberOrigin, Numbering};
pub use numpy::NumpyFile;
pub use quality::{Below, Gate, Quality, Worst};
pub use selection::{ListedSides, Selection};
pub use source::{Format, MeshSource, SourceBlock};
pub use voxels::VoxelMesh;
