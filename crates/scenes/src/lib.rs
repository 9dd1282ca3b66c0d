//! Scenes: files that name a body, its material, its fits, supports and loads, and what is worked out from one of them.
//!
//! Users of springfit need not name this crate.
//!
//! | module | what it holds |
//! |---|---|
//! | `scene`, `sweep` | the keys of a scene file, and what they mean on its mesh |
//! | `body` | the loads of a scene, and its finite element solutions |
//! | `fits` | the kinds of fits: their keys, their work, their outcomes |
//! | `time` | motions, natural frequencies and dynamic moduli |
//! | `timing` | what fits and models cost |
//! | `outcome` | the results of a scene |

#![forbid(unsafe_code)]

mod body;
mod body_material;
mod checkpoint;
mod choice;
mod cost;
mod extent;
mod fits;
mod fitting;
mod keys;
mod masses;
mod outcome;
mod own_name;
mod progress;
mod scene;
mod sweep;
mod time;
mod timing;

// The layers below, by the same names as everywhere.
use springfit_analysis::analysis;
use springfit_bodies::{dynamics, engine, model, solve};
use springfit_element::{element, material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::{
    bound, clock, error, file, named, number, order, quantity, random, range, scalar, symbolic, text,
};
use springfit_identify::{calibration, positive, whole};
use springfit_mesh::mesh;

pub use body::{
    Case, FinerAnswer, FinerBody, Gauged, LargeBody, LinearBody, applied_cases, judge_by_quadratic_elements,
    judge_sheet, load_cases, load_notes, quadratic_answers, seconds_of_body, seconds_of_network,
};
pub use body_material::{BodyConstants, Stated, assumed};
pub use checkpoint::Controls;
pub use choice::choice;
pub use cost::{COMPARISONS, REFINEMENTS, entries};
pub use extent::{extends, unit_note};
pub use fits::{
    CellMethod, EngineEntry, EngineErrors, EngineLimit, EngineOutcome, EngineVibration, ExactOutcome, ExactRecipe,
    ExactRecord, FamilyOutcome, FitEntry, FitFunctions, FitKind, FitLimit, Fitted, FittedKind, FittedLoad,
    FittedMasses, ForceRecipe, FoundModuli, FoundModulus, HeldOut, KindRecord, LoadSelection, MadeLoads, ModelError,
    ModelFrequencies, ModuliSearch, NamedFit, PublishedOutcome, PublishedRecord, Recipe, Reference, SampledOutcome,
    SampledRecipe, SampledRecord, ScaledLoad, SceneFacts, SetStates, ShapeOrigin, ShapesRecord, Sharing, Start,
    StartOutcome, StiffnessOutcome, StiffnessRecord, SupportFrequencies, SupportPart, Task, TensionOutcome,
    ValidationRecipe, WholeBody, WholeOutcome, WholeRecipe, WholeRecord, WorseLoad, WorstShape, fit_schema, law_at,
};
pub use fitting::{fit_mesh, fit_without_errors, matrix_errors};
pub use keys::keys;
pub use masses::{PointMasses, point_masses};
pub use outcome::{
    BodyLoad, ComplexModulus, DynamicModuli, DynamicModuliOfModel, DynamicModuliOutcome, FitOutcome, Followed,
    FrequencyOutcome, GaugeResult, LoadOutcome, MatrixErrors, Measured, ModelMotion, MotionEnding, MotionOutcome,
    Outcome, Reading, Record, Standard, TimedForce, TimedPull, standing_word,
};
pub use own_name::{BODY, QUADRATIC, expect_own_name};
pub use progress::{Event, Progress};
pub use scene::{
    AppliedForce, BoxEntry, CalibrationRecipe, CellValues, DampingRecipe, DiscEntry, FillEntry, ForcePrecision, Hold,
    InMemory, LoadCase, LoadKind, Materials, MeasuredDamping, MeshInput, MeshLength, MotionRecipe, Output, Part,
    PrescribedMotion, Reaction, ReferenceEntry, Scene, Setting, check_unit, load_element, load_elements, motion_title,
    scene_schema,
};
pub use sweep::SweepEntry;
pub use time::{RELEASE, Raised, TimePlan};
pub use timing::{
    Costed, FitTimes, ModelTimes, STACK, Statics, TimedWork, Times, interleaved_after, model_times, on_one_thread,
    time_fits,
};
