//! What a whole-object fit has to say to its reader.

use super::made_loads::MadeLoads;
use super::outcome::{FittedMasses, ModelFrequencies, SupportFrequencies, WholeOutcome, WorseLoad};

/// A relative error under a load from which on a fit has not enough unknowns of the right kind.
// It was chosen well above what fits with enough unknowns leave, a few percent under loads that they have not seen, and below the
// errors of the coarse finite elements that they are to improve on.
const CAPACITY: f64 = 0.2;
/// The error under the fitted loads that a fit with enough unknowns leaves where ρ is least, at most.
// It is a tenth of the error above: then it is not the springs that leave that error, but the choice of ρ.
const FITTED: f64 = 0.02;

impl WholeOutcome {
    /// The largest relative error after the fit under the loads that it has seen.
    fn largest_left(&self) -> f64 {
        let loads = self.fitted.iter().chain(&self.judged);
        loads.map(|load| load.after).filter(|error| error.is_finite()).fold(0.0, f64::max)
    }

    /// Notes for the reader, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let validated = match &self.validated[..] {
            [] => String::new(),
            loads => format!(", regularization rho chosen by {}", loads.join(", ")),
        };
        let done = match self.regularization {
            Some(rho) => {
                let (change, range) = (self.change, self.range);
                format!(
                    "rho {rho:.0e}, {} steps, constants changed by factors up to {change:.1}, range {range:.0}",
                    self.steps
                )
            }
            None if !self.stands => "the start is not stable under each of them, so its constants are unchanged".into(),
            // A stage within the noise is taken, unless the start is within it as well.
            None if self.is_by_noise && self.curve.iter().any(|stage| stage.validated.is_some_and(|e| e <= 1.0)) => {
                "the start is within the noise, so its constants are unchanged".into()
            }
            None => {
                let tried = self.curve.len();
                format!(
                    "none of {tried} values of rho gave smaller errors than the start, in {} steps; its constants are unchanged",
                    self.steps
                )
            }
        };
        let largest = |errors: &[f64]| 100.0 * errors.iter().fold(0.0f64, |a, e| a.max(e.abs()));
        let [before, after] = [&self.frequencies.before, &self.frequencies.after].map(|errors| largest(errors));
        let done = match self.frequencies.before.len() {
            0 => done,
            count => format!("{done}, {count} frequencies off by up to {before:.1} -> {after:.1} %"),
        };
        let ended = match (self.cancelled, self.limited, self.excess) {
            (true, ..) => "; it was ended early".into(),
            _ if self.exceeds => "; the range is larger than the one that is allowed where rho is chosen".into(),
            (_, true, _) => "; a better rho exceeds the range that is allowed".into(),
            (.., Some(excess)) if excess > 1.0 => {
                format!("; no rho that was tried reaches the noise: residuals are {excess:.2} times as large")
            }
            _ => String::new(),
        };
        let percent = |error: f64| format!("{:.2}", 100.0 * error);
        // The errors themselves are a table.
        let held_out = self.held_out.iter().filter_map(|held_out| {
            let worse = |load: &WorseLoad| {
                format!("{} {} / {}", load.load, percent(load.finite_elements), percent(load.fitted))
            };
            let worse: Vec<String> = held_out.worse.iter().map(worse).collect();
            let listed = (!worse.is_empty()).then(|| {
                format!(
                    "loads worse than finite elements by more than a tenth (errors in %, finite elements / fitted): {}",
                    worse.join(", ")
                )
            });
            let said: Vec<String> = held_out.gain().into_iter().chain(listed).collect();
            let (loads, place) = (held_out.loads, held_out.place());
            (!said.is_empty()).then(|| format!("under {loads} other loads, held at {place}: {}", said.join("; ")))
        });
        let fitted = format!(
            "fitted to {}, so that errors under them are not predictions{validated}: {done}{ended}",
            self.loads.join(", ")
        );
        let moduli = self.moduli.notes();
        let stretched = self.stretched.iter().flat_map(MadeLoads::notes);
        let guessed = (!self.guessed.is_empty()).then(|| {
            format!(
                "displacements under {} are those of finite elements with the moduli of the scene, a guess where others are measured; \
                 validate = \"leave-one-out\" or \"discrepancy\" needs none of them",
                self.guessed.join(", ")
            )
        });
        let unmeasured = (!self.unmeasured.is_empty()).then(|| {
            let loads = self.unmeasured.join(", ");
            format!("errors under {loads} are those against finite elements with the moduli of the scene, not with those that were found")
        });
        let masses = self.masses.iter().flat_map(FittedMasses::notes);
        let rest = [self.capacity(), guessed, unmeasured].into_iter().flatten();
        std::iter::once(fitted).chain(moduli).chain(stretched).chain(held_out).chain(masses).chain(rest).collect()
    }

    /// What limits a fit that leaves large errors: the springs, or the loads that have chosen ρ.
    fn capacity(&self) -> Option<String> {
        let left = self.largest_left();
        // The note on the engine has these errors.
        if !(left > CAPACITY) || self.is_exact || self.is_for_engine {
            return None;
        }
        let least = self.curve.iter().filter_map(|stage| Some((stage.trained?, stage.regularization)));
        match least.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((error, rho)) if error < FITTED => Some(format!(
                "errors of up to {:.0} % are left: rho {rho:.0e} leaves {:.2} % (rms) under the loads that are fitted, and what has chosen rho \
                 does not want it",
                100.0 * left,
                100.0 * error
            )),
            _ => Some(format!(
                "errors of up to {:.0} % are left: springs with the rest lengths of the mesh cannot do better here; start = \"exact\" has \
                 the capacity",
                100.0 * left
            )),
        }
    }
}

impl FittedMasses {
    fn notes(&self) -> Vec<String> {
        let (count, total, change) = (self.count, self.total, self.change);
        let second = format!(
            "mass and centre are those of the body, second moments up to {:.1} % off",
            100.0 * self.second_error
        );
        let first = format!(
            "masses fitted to the first {count} frequencies under each support, {total:.4e} kg in all, changed by factors up to \
             {change:.1}, rho {:.0e}: {second}",
            self.regularization
        );
        let support = |of: &SupportFrequencies| {
            let seen = of.part.words();
            let model = |m: &ModelFrequencies| format!("{} {:.2} / {:.2}", m.model, 100.0 * m.first, 100.0 * m.next);
            let models: Vec<String> = of.models.iter().map(model).collect();
            let (support, last) = (&of.support, 2 * count);
            format!(
                "frequencies 1 to {count} / {} to {last} off by (rms, %), held at {support}{seen}: {}",
                count + 1,
                models.join(", ")
            )
        };
        let matrix = format!(
            "mass matrix for programs that have one: {:.3} of the consistent one and {:.3} of lumped masses",
            1.0 - self.share,
            self.share
        );
        [first, matrix].into_iter().chain(self.supports.iter().map(support)).collect()
    }
}
