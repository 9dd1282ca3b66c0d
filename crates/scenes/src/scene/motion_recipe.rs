//! The motion of a scene, checked, before the mesh is known.
//!
//! Theory: page *Dynamics* of the book.

use super::damping::MeasuredDamping;
use super::material::MaterialEntries;
use super::part::Part;
use crate::dynamics::Options;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Lumping;
use crate::symbolic::Expr;

/// A tolerance for the quotient of duration and step, because decimals are not exact in binary.
pub(super) const SLACK: f64 = 1.0 - 1e-12;

/// A motion, before the mesh is known.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionRecipe {
    /// The time step, the method and the solver.
    pub options: Options,
    /// The numbers of the networks' forces.
    pub precision: ForcePrecision,
    /// The duration, s.
    pub duration: f64,
    /// The number of steps; the last one reaches the end.
    pub steps: usize,
    /// The time between states that are written, s; the first and the last state always are.
    pub every: f64,
    /// How masses are lumped.
    pub lumping: Lumping,
    /// The acceleration of gravity, m/s², `[dimension]`. The list is empty without gravity.
    pub gravity: Vec<f64>,
    /// The damping.
    pub damping: DampingRecipe,
    /// What was measured of the damping, if Rayleigh's numbers were fitted to it.
    pub measured_damping: Option<MeasuredDamping>,
    /// The points whose mean displacement is written.
    pub watch: Option<Part>,
    /// Whether the finite elements move as well.
    pub finite_elements: bool,
    /// The prescribed displacements.
    pub pulls: Vec<PrescribedMotion>,
    /// The forces.
    pub forces: Vec<AppliedForce>,
}

/// The numbers in which networks compute their forces, and, without an account, positions and velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ForcePrecision {
    /// `f64`.
    #[default]
    Double,
    /// `f32`.
    Single,
}

crate::named!(ForcePrecision {
    "double" => Double,
    "single" => Single,
});

/// A motion in words, with times in s and the names of the integrator and of the precision.
pub fn motion_title(duration: f64, steps: usize, step: f64, integrator: &str, precision: &str) -> String {
    let precision = if precision == ForcePrecision::Double.name() { "" } else { " in single precision" };
    format!("{duration:?} s in {steps} steps of {step:?} s by {integrator}{precision}")
}

/// The damping of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DampingRecipe {
    /// Rayleigh damping: α, 1/s, and β, s, of `C = α M + β K₀`.
    Rayleigh([f64; 2]),
    /// The damping ratio of a damper parallel to each spring.
    Ratio(f64),
}

impl DampingRecipe {
    /// Whether something is damped.
    pub fn is_there(self) -> bool {
        match self {
            DampingRecipe::Rayleigh(numbers) => numbers.iter().any(|number| *number > 0.0),
            DampingRecipe::Ratio(ratio) => ratio > 0.0,
        }
    }
}

/// A part with a prescribed displacement over time, m.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMotion {
    /// The part.
    pub part: Part,
    /// One expression in t, x, y, z per direction; `None` leaves a direction free.
    pub displacement: Vec<Option<Expr>>,
}

/// A force over time, N, on a part.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedForce {
    /// The part.
    pub part: Part,
    /// One expression in t per direction.
    pub force: Vec<Expr>,
    /// Whether the force acts on each point, instead of being the total.
    pub each: bool,
}

impl MotionRecipe {
    /// Whether masses count: by inertia or by gravity.
    pub(super) fn needs_masses(&self) -> bool {
        !self.options.quasi_static || !self.gravity.is_empty()
    }

    /// Checks that a material that relaxes, or one that does not, can move so.
    ///
    /// # Errors
    /// Steps are divided and nothing relaxes; or springs would turn without a law, or be linear with one, or forces are in single precision.
    pub(super) fn check_relaxing(&self, material: &MaterialEntries) -> Result<()> {
        let relaxes = material.all.iter().any(|entry| entry.relaxation.is_some());
        let has_law = material.first().law.is_some();
        if !relaxes {
            return match self.options.error {
                Some(_) => Err(Error::at("error", "belongs to a material with \"relaxation\", found one without")),
                None => Ok(()),
            };
        }
        if self.options.linear == has_law {
            let expected = match has_law {
                true => "false with [material.relaxation] and a law: its springs turn and stretch",
                false => {
                    "true with [material.relaxation] and no law: a history of tensions does not turn with the body"
                }
            };
            let found = if self.options.linear { "true" } else { "false, which is the default" };
            return Err(Error::expected("linear", expected, found).of_kind(ErrorKind::Unsupported));
        }
        if self.precision == ForcePrecision::Single {
            let expected = "\"double\" with [material.relaxation]";
            return Err(Error::expected("precision", expected, "\"single\"").of_kind(ErrorKind::Unsupported));
        }
        Ok(())
    }

    /// The motion in words.
    pub fn title(&self) -> String {
        let (step, integrator) = (self.options.step, self.options.method());
        motion_title(self.duration, self.steps, step, integrator, self.precision.name())
    }

    /// The time at the end of the last step, s: that of the first step that reaches the duration.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.options.step
    }

    /// Whether the times between states that are written are alike but for the last one.
    pub fn is_even(&self) -> bool {
        let written = self.written();
        let apart: Vec<usize> = written.windows(2).map(|pair| pair[1] - pair[0]).collect();
        apart.split_last().is_none_or(|(_, apart)| apart.iter().all(|steps| *steps == apart[0]))
    }

    /// The steps at whose end a state is written: the first one at or after each multiple of `every`, and the last
    /// step.
    pub fn written(&self) -> Vec<usize> {
        let at = |state: usize| (state as f64 * self.every / self.options.step * SLACK).ceil() as usize;
        let mut steps: Vec<usize> = (0..).map(at).take_while(|step| *step < self.steps).collect();
        steps.push(self.steps);
        steps.dedup();
        steps
    }
}
