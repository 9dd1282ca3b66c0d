//! Scenes, and the studies that are made from them. [`Scene`] reads and checks a scene file, and [`run`](run()) fits
//! its springs, solves its loads with both models and compares them; the result is an [`Outcome`].

#[doc(inline)]
pub use springfit_studies::study::{
    BodyLoad, CalibratedLoad, CalibratedRegion, CalibrationOutcome, CaseRecord, CellValues, Comparing, ComplexModulus,
    Controls, Convergence, DampingRecipe, DisplacementError, DraftMaterial, DynamicModuli, DynamicModuliOutcome,
    EffectiveModuli, EngineEntry, EngineOutcome, Event, ExactOutcome, FillEntry, FitEntry, FitOutcome, FitTimes,
    FittedKind, Followed, Forecast, FrequencyOutcome, GaugeResult, HeldOut, InMemory, Inspection, Lattice, Level,
    Limit, LoadKind, LoadOutcome, Materials, MatrixErrors, MeasureOptions, Measured, MeasuredNetwork, MeshInput,
    MeshLength, MethodRecord, ModelMotion, ModelTimes, MotionOutcome, MotionRecipe, NetworkMaterial, Outcome, Paper,
    Part, Progress, PublishedOutcome, Recipe, Reference, SampledOutcome, Scene, StabilityOutcome, StabilityRow,
    Standard, StiffnessOutcome, Stretches, Study, Sweep, TensionOutcome, Times, WholeOutcome, calibrate,
    compare_element, compare_scene, compare_stretches, converge_to, draft, fit_mesh, learning_curve, matrix_errors,
    measure, moduli_of_body, network_material, run_paper, run_with, scene_schema, stability, stability_of_scene,
};

/// A fit by the keys of a table `[[fit]]`.
///
/// ```
/// use springfit::study::Scene;
///
/// let scene = Scene::load("scenes/square_quad.toml".as_ref())?;
/// let names: Vec<&str> = scene.fits().iter().map(|fit| fit.name.as_str()).collect();
/// assert!(names.contains(&"offdiag"));
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_studies::study::NamedFit;

/// A key of a scene that is set beside its file.
///
/// ```
/// use springfit::study::{Scene, Setting};
///
/// let settings = [Setting::parse("material.poisson = 0.45")?];
/// let scene = Scene::load_with("scenes/square_quad.toml".as_ref(), &settings)?;
/// assert_eq!(scene.settings().len(), 1);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_studies::study::Setting;

/// The errors of a scene on finer and finer meshes.
///
/// ```
/// use springfit::study::{Scene, converge};
///
/// let scene = Scene::load("scenes/square_quad.toml".as_ref())?;
/// let convergence = converge(&scene, Some(2), &mut |_| ())?;
/// assert_eq!(convergence.levels.len(), 2);
/// assert!((convergence.levels[1].size / convergence.levels[0].size - 0.5).abs() < 1e-9);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_studies::study::converge;

/// The error of displacements, in percent of the largest one.
///
/// ```
/// let fem = [0.0, 0.0, 3.0, 4.0]; // m, of two points in the plane
/// let springs = [0.0, 0.0, 3.0, 3.0];
/// let error = springfit::study::displacement_error(&fem, &springs, 2).expect("points that move");
/// assert!((error.max - 20.0).abs() < 1e-12);
/// ```
#[doc(inline)]
pub use springfit_studies::study::displacement_error;

/// The properties that the use of an element relies on, proved for its file.
///
/// ```
/// use springfit::element::Element;
/// use springfit::study::inspect;
///
/// let inspection = inspect("hex8", Element::load("hex8"));
/// assert!(inspection.passes && inspection.properties.len() > 3);
/// ```
#[doc(inline)]
pub use springfit_studies::study::inspect;

/// The fits of a scene, and the errors of their networks under its loads.
///
/// ```
/// use springfit::study::{Scene, run};
///
/// let outcome = run(&Scene::load("scenes/square_quad.toml".as_ref())?, &mut |_| ())?;
/// assert!(outcome.fits.iter().any(|fit| fit.fit.name == "offdiag"));
/// assert_eq!(outcome.loads.len(), 2);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_studies::study::run;
