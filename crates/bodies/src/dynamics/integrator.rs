//! Time integration methods.
//!
//! Theory: page *Dynamics* of the book.

use crate::error::{Error, Result};

/// How a step is made. With Δ = x − x_n the displacement of the step and h its length, the implicit methods solve
/// `M a + C v + F(x) = f` at its end, with v and a linear in Δ: `v = c₁ (Δ − ẑ)`, `a = c₂ (Δ − ŷ)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Integrator {
    /// `v = Δ/h`, `a = (v − v_n)/h`. First order. Stable with any step; it damps motions that the step does not
    /// resolve, and without forces the energy never grows. With one iteration it is the linearised form of Baraff and
    /// Witkin (SIGGRAPH 1998).
    #[default]
    ImplicitEuler,
    /// `v = (3x − 4x_n + x_{n−1})/2h`, `a = (3v − 4v_n + v_{n−1})/2h`, with a first step by implicit Euler. Second
    /// order; damps fast vibrations.
    Bdf2,
    /// `Δ = h v_n + h² ((½ − β) a_n + β a)`, `v = v_n + h ((1 − γ) a_n + γ a)` (Newmark 1959). With γ = ½ it has second
    /// order and no numerical damping. On linear models it is stable with any step if `2β ≥ γ ≥ ½`.
    Newmark {
        /// β, above 0.
        beta: f64,
        /// γ, at least ½.
        gamma: f64,
    },
    /// `v = v_n + h M⁻¹ (f − C v_n − F(x_n))`, `x = x_n + h v`. First order, explicit, without drift of the energy; the
    /// step is limited.
    SymplecticEuler,
}

crate::named!(Integrator {
    "implicit-euler" => ImplicitEuler,
    "bdf2" => Bdf2,
    "newmark" => Newmark { beta: 0.25, gamma: 0.5 },
    "symplectic-euler" => SymplecticEuler,
});

impl Integrator {
    /// The average acceleration method, β = 1/4 and γ = 1/2, which conserves the energy of a linear model.
    pub fn newmark() -> Integrator {
        Integrator::Newmark { beta: 0.25, gamma: 0.5 }
    }

    pub(super) fn check(self) -> Result<()> {
        match self {
            // β = 0 is an explicit method, and γ below ½ makes vibrations grow.
            Integrator::Newmark { beta, gamma } if !(beta > 0.0 && gamma >= 0.5 && beta + gamma < f64::INFINITY) => {
                Err(Error::expected("newmark", "beta above 0 and gamma from 1/2", format!("{beta} and {gamma}")))
            }
            _ => Ok(()),
        }
    }

    /// `[c₁, c₂]` for the step h in s; `first` for a step without a previous one.
    pub(super) fn coefficients(self, h: f64, first: bool) -> [f64; 2] {
        match self {
            // Two states are known from the second step on. The derivative of Δ is 3/2h, and the second derivative
            // takes it twice.
            Integrator::Bdf2 if !first => [1.5 / h, 2.25 / (h * h)],
            Integrator::Newmark { beta, gamma } => [gamma / (beta * h), 1.0 / (beta * h * h)],
            _ => [1.0 / h, 1.0 / (h * h)],
        }
    }

    /// The ẑ and ŷ of one degree of freedom.
    pub(super) fn predict(self, h: f64, first: bool, past: Past) -> [f64; 2] {
        let Past { v, a, way, before } = past;
        match self {
            Integrator::Bdf2 if !first => {
                // From `v = (3Δ − way)/2h`, and with it `a = (3v − 4v_n + v_{n−1})/2h`.
                let z = way / 3.0;
                [z, z + h * (4.0 * v - before) * 2.0 / 9.0]
            }
            Integrator::Newmark { beta, gamma } => {
                let y = h * v + h * h * (0.5 - beta) * a;
                // From `a = (Δ − y)/βh²`, put into the rule of v and solved for Δ.
                [y - (v + h * (1.0 - gamma) * a) * beta * h / gamma, y]
            }
            // Implicit Euler: `v = Δ/h` and `a = (Δ − h v_n)/h²`.
            _ => [0.0, h * v],
        }
    }

    /// Whether a step requires the acceleration before it.
    pub(super) fn needs_acceleration(self) -> bool {
        matches!(self, Integrator::Newmark { .. })
    }
}

/// The history of one degree of freedom that a method uses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Past {
    pub v: f64,
    pub a: f64,
    /// `x_n − x_{n−1}`.
    pub way: f64,
    /// `v_{n−1}`.
    pub before: f64,
}
