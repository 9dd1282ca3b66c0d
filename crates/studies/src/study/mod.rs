//! Whole studies: a scene, from its file to the errors and times of each fit.
//!
//! [`Scene`] reads and checks a scene file, and [`run`](run()) fits its springs, solves its loads with both models and
//! compares them; the result is an [`Outcome`]. The other studies use the same parts: [`compare_element`] and
//! [`compare_scene`] compare objectives and solvers, [`converge`] refines the mesh, [`compare_stretches`] pulls to
//! large deformation, [`stability`](stability()) tries extreme cases, [`Sweep`] runs a scene for many values of its keys, [`inspect`] proves an element file, and [`run_paper`] repeats the
//! experiments of a paper.
//!
//! Studies are silent; they report through a [`Progress`] callback.

mod calibration;
mod compare;
mod convergence;
mod distributed;
mod draft;
mod forecast;
mod jobs;
mod learning;
mod measure;
mod paper;
mod run;
mod stability;
mod stages;
mod stretches;
mod sweep;

// A study and its scene are named by one path.
pub use springfit_scenes::*;

pub use crate::analysis::check::{Inspection, Mark, Property, inspect, spurious_modes};
pub use crate::analysis::homogenise::{ClosedTensor, Elasticity, NamedLattice, Root, Tension, strain_names};
pub use crate::analysis::locking::{LACKING, Locking, TooStiff, bends};
pub use crate::analysis::metrics::{DisplacementError, displacement_error};
pub use crate::analysis::moduli::{EffectiveModuli, Lattice, moduli_of_body};
pub use crate::analysis::shapes::random_shapes;
pub use crate::analysis::statistics;
pub use crate::analysis::tensor::{NetworkMaterial, SpringOwners, network_material};
pub use calibration::{
    CalibratedLoad, CalibratedRegion, CalibrationOutcome, MeshStep, Readings, Seen, Value, calibrate, calibrate_with,
};
pub use compare::{
    Case as ComparedCase, CaseRecord, Comparing, MethodOutcome, MethodRecord, compare_element, compare_scene,
    compare_schema, compared, is_comparison, measure_recipes,
};
pub use convergence::{
    Convergence, EachLevel, Level, Limit, LimitKind, LoadConvergence, MOST_LEVELS, ModelConvergence, Step, converge,
    converge_to, converge_with, limit_of, most_unknowns, rates, refinements,
};
pub use distributed::{BodyShare, FittedShare, distributed_body, fit_some};
pub use draft::{DraftMaterial, DraftSource, DraftUnit, draft};
pub use forecast::{ExpectedStage, Forecast};
pub use jobs::check_jobs;
pub use learning::{LearningPoint, learning_curve};
pub use measure::{MeasureOptions, MeasuredNetwork, MeasuredRegion, NetworkStability, measure};
pub use paper::{
    Column, Index, Paper, PaperRow, PaperTable, Surface, check_experiments, file_stem, heading, run_paper,
    write_experiments,
};
pub use run::{engine_limits, run, run_with};
pub use stability::{Family, StabilityOutcome, StabilityRow, Verdict, stability, stability_of_scene};
pub use stages::stages;
pub use stretches::{STRETCHES, SampledRun, StretchedFit, Stretches, compare_stretches};
pub use sweep::{Study, Sweep};
