//! The settings at which an engine runs a network.

use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An engine, or a method whose settings are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// Extended position-based dynamics (Macklin, Müller and Chentanez 2016).
    Xpbd,
    /// Vertex block descent (Chen and others 2024).
    Vbd,
    /// Jolt: XPBD whose substeps have one sweep each.
    Jolt,
    /// The XPBD solver of Newton: Jacobi sweeps.
    NewtonXpbd,
    /// The VBD solver of Newton.
    NewtonVbd,
}

crate::named!(Engine {
    "xpbd" => Xpbd,
    "vbd" => Vbd,
    "jolt" => Jolt,
    "newton-xpbd" => NewtonXpbd,
    "newton-vbd" => NewtonVbd,
});

/// How a sweep goes through the springs or the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sweep {
    /// One after the other, each with what those before it have moved.
    GaussSeidel,
    /// All at once, from where the points were before the sweep.
    Jacobi,
}

crate::named!(Sweep { "gauss-seidel" => GaussSeidel, "jacobi" => Jacobi });

/// The order in which a sweep takes the springs, or the points of vertex block descent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// Colour after colour; those of one colour share no point, so that they can be taken in parallel.
    Colours,
    /// As they are in the network: springs on lengths by their points, then those on contents.
    Given,
    /// As Jolt takes them: those on contents before those on lengths, and each from the held points outwards.
    Jolt,
}

crate::named!(Order { "colours" => Colours, "given" => Given, "jolt" => Jolt });

/// The numbers with which positions are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 32 bits.
    Single,
    /// 64 bits.
    Double,
}

crate::named!(Precision { "single" => Single, "double" => Double });

/// The settings at which an engine runs a network. Constants that were fitted for them belong to them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// The engine, or the method, has this name.
    #[serde(rename = "method")]
    pub engine: Engine,
    /// The engine is asked for steps of this length in s, such as one frame.
    pub step: f64,
    /// A step is divided into this number of substeps.
    pub substeps: usize,
    /// A substep has this number of sweeps.
    pub iterations: usize,
    /// A sweep takes springs or points one after the other or all at once.
    pub sweep: Sweep,
    /// A correction is multiplied by this factor; in Newton's XPBD that of a spring on a content alone.
    pub relaxation: f64,
    /// A sweep takes the springs, or the points of `vbd`, in this order.
    pub order: Order,
    /// Positions are stored with this precision.
    pub precision: Precision,
}

/// The step of most games and of the engines' examples, s.
const FRAME: f64 = 1.0 / 60.0;
/// A longer step than any engine makes, s.
// A step above it is a number of another unit, such as the microseconds of a frame.
const LONGEST: f64 = 1000.0;
/// The least factor on a correction that moves anything.
// A sweep then leaves 99.9 % of a violation: a thousand of them do what one does with the factor 1.
const LEAST_RELAXATION: f64 = 1e-3;
/// More substeps than any engine makes, and more iterations.
// Each is a sweep over all springs, for each of the solutions of a fit.
const MOST: usize = 100_000;

impl Setting {
    /// The settings that an engine has by default.
    pub fn usual(engine: Engine) -> Setting {
        let (substeps, iterations) = match engine {
            Engine::Xpbd => (10, 1),
            Engine::Vbd => (1, 10),
            // Jolt calls its substeps iterations.
            Engine::Jolt => (5, 1),
            Engine::NewtonXpbd => (10, 2),
            Engine::NewtonVbd => (10, 10),
        };
        let order = match engine {
            Engine::Jolt => Order::Jolt,
            Engine::Xpbd | Engine::Vbd | Engine::NewtonXpbd | Engine::NewtonVbd => Order::Colours,
        };
        let sweep = if engine == Engine::NewtonXpbd { Sweep::Jacobi } else { Sweep::GaussSeidel };
        // 0.9 is the default `soft_body_relaxation` of Newton's SolverXPBD.
        let relaxation = if engine == Engine::NewtonXpbd { 0.9 } else { 1.0 };
        let precision = Precision::Single;
        Setting { engine, step: FRAME, substeps, iterations, sweep, relaxation, order, precision }
    }

    /// Whether sweeps go over the points, and not over the springs.
    pub fn is_by_points(&self) -> bool {
        matches!(self.engine, Engine::Vbd | Engine::NewtonVbd)
    }

    /// The length h of a substep, s.
    pub fn substep(&self) -> f64 {
        self.step / self.substeps as f64
    }

    /// The settings with another number of substeps.
    #[must_use]
    pub fn with_substeps(self, substeps: usize) -> Setting {
        Setting { substeps, ..self }
    }

    /// Checks the ranges, and that an engine of a name is asked for what it does.
    ///
    /// # Errors
    /// A value is out of range or another than that of the engine; the error has its key.
    pub fn check(&self) -> Result<()> {
        if !(self.step > 0.0 && self.step <= LONGEST) {
            return Err(Error::expected("step", format!("a time above 0 s and at most {LONGEST} s"), self.step));
        }
        for (key, count) in [("substeps", self.substeps), ("iterations", self.iterations)] {
            if !(1..=MOST).contains(&count) {
                return Err(Error::expected(key, format!("a whole number from 1 to {MOST}"), count));
            }
        }
        // Successive over-relaxation converges below the factor 2 alone (Ostrowski, Reich).
        if !(self.relaxation >= LEAST_RELAXATION && self.relaxation < 2.0) {
            let expected = format!("a factor of at least {LEAST_RELAXATION} and below 2");
            return Err(Error::expected("relaxation", expected, self.relaxation));
        }
        let usual = Setting::usual(self.engine);
        let own = |key: &str, expected: &str, found: &str| {
            Err(Error::expected(key, format!("\"{expected}\", as {} does", self.engine.name()), format!("\"{found}\"")))
        };
        match self.engine {
            Engine::Xpbd => Ok(()),
            Engine::Vbd if self.order == Order::Jolt => own("order", usual.order.name(), self.order.name()),
            Engine::Vbd if self.sweep == Sweep::Jacobi => own("sweep", usual.sweep.name(), self.sweep.name()),
            Engine::Vbd => Ok(()),
            // An engine of a name has one loop: a fit for another would be for no engine.
            _ if self.sweep != usual.sweep => own("sweep", usual.sweep.name(), self.sweep.name()),
            _ if self.order != usual.order => own("order", usual.order.name(), self.order.name()),
            _ if self.precision != usual.precision => own("precision", usual.precision.name(), self.precision.name()),
            Engine::Jolt if self.iterations != 1 => {
                let expected = "1: what Jolt calls iterations are substeps of one sweep";
                Err(Error::expected("iterations", expected, self.iterations))
            }
            Engine::Jolt | Engine::NewtonVbd if self.relaxation != usual.relaxation => {
                let expected = format!("{}, as {} does", usual.relaxation, self.engine.name());
                Err(Error::expected("relaxation", expected, self.relaxation))
            }
            Engine::Jolt | Engine::NewtonXpbd | Engine::NewtonVbd => Ok(()),
        }
    }

    /// The settings in words.
    pub fn words(&self) -> String {
        let rate = 1.0 / self.step;
        // A sixtieth of a second has no short decimal number.
        let step = match (rate - rate.round()).abs() < 1e-9 * rate && rate >= 1.0 {
            true => format!("1/{} s", rate.round()),
            false => format!("{} s", self.step),
        };
        let plural = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let relaxed = if self.relaxation == 1.0 { String::new() } else { format!(" relaxed by {}", self.relaxation) };
        format!(
            "{}, {} of {step} with {} each, {}{relaxed}, order {}",
            self.engine.name(),
            plural(self.substeps, "substep"),
            plural(self.iterations, "sweep"),
            self.sweep.name(),
            self.order.name()
        )
    }
}
