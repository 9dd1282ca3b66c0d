//! Motion in time: integrators, damping, drives, conservation of energy.

#[doc(inline)]
pub use springfit_bodies::dynamics::{
    BranchForm, BranchTerm, Curve, Damping, Drive, EnergyBalance, Integrator, LinearSolver, Memory, Motion,
    MotionState, Options, Step, StepOutcome,
};

/// A motion, step by step: a point that falls for a second reaches `−g t`.
///
/// ```
/// use springfit::dynamics::{Drive, Motion, Options, Simulation};
/// use springfit::model::{LengthSpring, Network};
///
/// let spring = LengthSpring { points: [0, 1], constant: 50.0, rest: 1.0 }; // N/m, m
/// let network = Network { dimension: 2, lengths: vec![spring], others: Vec::new() };
/// let (points, masses) = ([0.0, 0.0, 1.0, 0.0], [0.1, 0.2]); // m, kg
/// let drive = Drive::default().gravity(&[0.0, -9.81]);
/// let motion = Motion { drive, ..Motion::free(&network, &points, &masses) };
/// let mut simulation = Simulation::new(motion, Options { step: 0.01, ..Options::default() })?;
/// (0..100).for_each(|_| drop(simulation.step()));
/// assert!((simulation.account().kinetic - 0.5 * 0.3 * 9.81f64.powi(2)).abs() < 0.3);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::dynamics::Simulation;
