//! Methods that take a motion from one time to the next.

use crate::error::{Error, Result};

/// How a step is made. The implicit ones solve `M a + C v + F(x) = f` at its end, with v and a that are linear in the way made:
/// `v = c₁ (Δ − ẑ)`, `a = c₂ (Δ − ŷ)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Integrator {
    /// `v = Δ/h`, `a = (v − v_n)/h`. First order; stable with any step, and damps what the step is too long for: without forces
    /// energy never grows. With one iteration the linearised form of Baraff and Witkin (SIGGRAPH 1998).
    #[default]
    ImplicitEuler,
    /// `v = (3x − 4x_n + x_{n−1})/2h`, `a = (3v − 4v_n + v_{n−1})/2h`, the first step by implicit Euler. Second order; damps fast
    /// vibrations.
    Bdf2,
    /// `Δ = h v_n + h² ((½ − β) a_n + β a)`, `v = v_n + h ((1 − γ) a_n + γ a)` (Newmark 1959). With γ = ½ of second order and without
    /// damping of its own; on linear models stable with any step if `2β ≥ γ ≥ ½`.
    Newmark { beta: f64, gamma: f64 },
    /// `v = v_n + h M⁻¹ (f − C v_n − F(x_n))`, `x = x_n + h v`. First order, explicit, no drift of the energy; the step has a limit.
    SymplecticEuler,
}

crate::named!(Integrator {
    "implicit-euler" => ImplicitEuler,
    "bdf2" => Bdf2,
    "newmark" => Newmark { beta: 0.25, gamma: 0.5 },
    "symplectic-euler" => SymplecticEuler,
});

impl Integrator {
    /// The average acceleration, β = 1/4 and γ = 1/2: of a linear model it keeps the energy.
    pub fn newmark() -> Integrator {
        Integrator::Newmark { beta: 0.25, gamma: 0.5 }
    }

    pub(super) fn check(self) -> Result<()> {
        match self {
            Integrator::Newmark { beta, gamma } if !(beta > 0.0 && gamma >= 0.5 && beta + gamma < f64::INFINITY) => {
                Err(Error::expected("newmark", "beta above 0 and gamma from 1/2", format!("{beta} and {gamma}")))
            }
            _ => Ok(()),
        }
    }

    /// `[c₁, c₂]` with the step h, s; `first` for a step without one before it.
    pub(super) fn coefficients(self, h: f64, first: bool) -> [f64; 2] {
        match self {
            Integrator::Bdf2 if !first => [1.5 / h, 2.25 / (h * h)],
            Integrator::Newmark { beta, gamma } => [gamma / (beta * h), 1.0 / (beta * h * h)],
            _ => [1.0 / h, 1.0 / (h * h)],
        }
    }

    /// ẑ and ŷ of one degree of freedom.
    pub(super) fn predict(self, h: f64, first: bool, past: Past) -> [f64; 2] {
        let Past { v, a, way, before } = past;
        match self {
            Integrator::Bdf2 if !first => {
                let z = way / 3.0;
                [z, z + h * (4.0 * v - before) * 2.0 / 9.0]
            }
            Integrator::Newmark { beta, gamma } => {
                let y = h * v + h * h * (0.5 - beta) * a;
                [y - (v + h * (1.0 - gamma) * a) * beta * h / gamma, y]
            }
            _ => [0.0, h * v],
        }
    }

    /// Whether a step asks for the acceleration before it.
    pub(super) fn needs_acceleration(self) -> bool {
        matches!(self, Integrator::Newmark { .. })
    }
}

/// What a method knows of one degree of freedom.
#[derive(Debug, Clone, Copy)]
pub(super) struct Past {
    pub v: f64,
    pub a: f64,
    /// `x_n − x_{n−1}`.
    pub way: f64,
    /// `v_{n−1}`.
    pub before: f64,
}
