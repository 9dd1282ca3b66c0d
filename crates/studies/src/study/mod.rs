//! Whole studies: a scene, from its file to the errors and times of each fit.
//!
//! [`Scene`] reads and checks a scene file, and [`run`](run()) fits its springs, solves its loads with both models and
//! compares them; the result is an [`Outcome`]. The other studies use the same parts: [`compare_element`] and
//! [`compare_scene`] compare objectives and solvers, [`converge`] refines the mesh, [`compare_stretches`] pulls to
//! large deformation, [`stability`](stability()) tries extreme cases, [`Sweep`] runs a scene for many values of its keys, [`inspect`] proves an element file, and [`run_paper`] repeats the
//! experiments of a paper.
//!
//! Studies are silent; they report through a [`Progress`] callback.

mod body;
mod body_material;
mod calibration;
mod checkpoint;
mod choice;
mod compare;
mod convergence;
mod cost;
mod distributed;
mod draft;
mod extent;
mod fits;
mod fitting;
mod forecast;
mod jobs;
mod keys;
mod learning;
mod locking;
mod masses;
mod measure;
mod outcome;
mod own_name;
mod paper;
mod progress;
mod run;
mod scene;
mod stability;
mod stages;
mod stretches;
mod sweep;
mod time;
mod timing;

pub use crate::analysis::check::{Inspection, Mark, Property, inspect, spurious_modes};
pub use crate::analysis::homogenise::{ClosedTensor, Elasticity, NamedLattice, Root, Tension, strain_names};
pub use crate::analysis::metrics::{DisplacementError, displacement_error};
pub use crate::analysis::moduli::{EffectiveModuli, Lattice, moduli_of_body};
pub use crate::analysis::shapes::random_shapes;
pub use crate::analysis::statistics;
pub use crate::analysis::tensor::{NetworkMaterial, SpringOwners, network_material};
pub use body::{Case, LargeBody};
pub use body_material::{BodyConstants, Stated, assumed};
pub use calibration::{
    CalibratedLoad, CalibratedRegion, CalibrationOutcome, MeshStep, Readings, Seen, Value, calibrate, calibrate_with,
};
pub use checkpoint::Controls;
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
pub use extent::unit_note;
pub use fits::{
    CellMethod, EngineEntry, EngineErrors, EngineLimit, EngineOutcome, EngineVibration, ExactOutcome, ExactRecipe,
    ExactRecord, FamilyOutcome, FitEntry, FitFunctions, FitKind, FitLimit, Fitted, FittedKind, FittedLoad,
    FittedMasses, ForceRecipe, FoundModuli, FoundModulus, HeldOut, KindRecord, LoadSelection, MadeLoads, ModelError,
    ModelFrequencies, ModuliSearch, NamedFit, PublishedOutcome, PublishedRecord, Recipe, Reference, SampledOutcome,
    SampledRecipe, SampledRecord, ScaledLoad, SceneFacts, SetStates, ShapeOrigin, ShapesRecord, Sharing, Start,
    StartOutcome, StiffnessOutcome, StiffnessRecord, SupportFrequencies, SupportPart, Task, TensionOutcome,
    ValidationRecipe, WholeBody, WholeOutcome, WholeRecipe, WholeRecord, WorseLoad, WorstShape, fit_schema,
};
pub use fitting::{fit_mesh, fit_without_errors, matrix_errors};
pub use forecast::{ExpectedStage, Forecast};
pub use learning::{LearningPoint, learning_curve};
pub use locking::{LACKING, Locking, TooStiff, bends};
pub use masses::{PointMasses, point_masses};
pub use measure::{MeasureOptions, MeasuredNetwork, MeasuredRegion, NetworkStability, measure};
pub use outcome::{
    BodyLoad, ComplexModulus, DynamicModuli, DynamicModuliOfModel, DynamicModuliOutcome, FitOutcome, Followed,
    FrequencyOutcome, GaugeResult, LoadOutcome, MatrixErrors, Measured, ModelMotion, MotionEnding, MotionOutcome,
    Outcome, Reading, Record, Standard, TimedForce, TimedPull, standing_word,
};
pub use own_name::{BODY, QUADRATIC};
pub use paper::{
    Column, Index, Paper, PaperRow, PaperTable, Surface, check_experiments, file_stem, heading, run_paper,
    write_experiments,
};
pub use progress::{Event, Progress};
pub use run::{engine_limits, run, run_with};
pub use scene::{
    AppliedForce, BoxEntry, CalibrationRecipe, CellValues, DampingRecipe, DiscEntry, FillEntry, ForcePrecision, Hold,
    InMemory, LoadCase, LoadKind, Materials, MeasuredDamping, MeshInput, MeshLength, MotionRecipe, Output, Part,
    PrescribedMotion, Reaction, ReferenceEntry, Scene, Setting, check_unit, load_elements, motion_title, scene_schema,
};
pub use stability::{Family, StabilityOutcome, StabilityRow, Verdict, stability, stability_of_scene};
pub use stages::stages;
pub use stretches::{STRETCHES, SampledRun, StretchedFit, Stretches, compare_stretches};
pub use sweep::{Study, Sweep, SweepEntry};
pub use timing::{FitTimes, ModelTimes, Times};
