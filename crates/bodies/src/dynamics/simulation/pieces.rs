//! Steps without inertia that are divided where stress relaxes fast.
//!
//! Theory: page *Springs that forget* of the book.

use super::Simulation;
use crate::dynamics::ledger::Ledger;
use crate::dynamics::memory::Memory;
use crate::dynamics::settle::{Step, StepOutcome};
use crate::dynamics::state::MotionState;

/// The largest number of pieces of a step.
// The error is of the second order: with so many pieces it is a millionth of that of one. A step that needs more is far too long, and
// counts with the error that it has.
const MOST: usize = 1024;
/// An estimate below this share of what is allowed halves the number of pieces: half as many have four times the error.
const SMALL: f64 = 0.1;

/// What a step changes.
struct Before {
    state: MotionState,
    memory: Option<Memory>,
    ledger: Option<Ledger>,
}

impl Simulation<'_> {
    /// Whether steps are divided.
    pub(super) fn divides(&self) -> bool {
        self.options.error.is_some() && self.motion.memory.is_some()
    }

    /// The largest error of a step so far that was estimated, as a share of the largest displacement at its end. The rule of relaxation takes
    /// displacements u to change evenly over a piece of the length h; the error is that of `h² u″/12`, by differences.
    pub fn estimated_error(&self) -> Option<f64> {
        self.divides().then_some(self.estimate)
    }

    /// Makes a step of the length h that ends at `time`, s, in as many pieces as its error asks for.
    pub(super) fn step_in_pieces(&mut self, time: f64, h: f64) -> Step {
        // Without a bound every error is allowed.
        let allowed = self.options.error.unwrap_or(f64::INFINITY);
        let before = self.before_step();
        // A difference of the second order needs two pieces.
        let mut count = self.pieces.max(2);
        loop {
            let (step, error) = self.pieces_to(time, h, count);
            let is_solved = matches!(step.outcome, StepOutcome::Converged | StepOutcome::Linearized);
            if count < MOST && !(is_solved && error <= allowed) {
                self.restore(&before);
                count *= 2;
                continue;
            }
            if matches!(step.outcome, StepOutcome::NoResponse | StepOutcome::Stalled) {
                // Where a piece is not solved, the step has no end.
                self.restore(&before);
                return Step { outcome: StepOutcome::NoResponse, ..step };
            }
            self.estimate = self.estimate.max(error);
            // A tenth leaves room: after a halving the error is 0.4 of what is allowed, and the next step does not
            // double again at once.
            self.pieces = if error < SMALL * allowed { count / 2 } else { count };
            return step;
        }
    }

    /// Makes a step in so many pieces; returns how it ended and the estimate of its error.
    fn pieces_to(&mut self, time: f64, h: f64, count: usize) -> (Step, f64) {
        let piece = h / count as f64;
        let mut all = Step::explicit(StepOutcome::Converged);
        let (mut last, mut curved) = (Vec::new(), 0.0f64);
        for i in 1..=count {
            // Counted back from the end, so that the last piece ends there to the last bit.
            let end = time - (count - i) as f64 * piece;
            let step = self.step_to(end, piece);
            all.iterations += step.iterations;
            all.solver_iterations += step.solver_iterations;
            all.modified += step.modified;
            all.residual = step.residual;
            if step.outcome != StepOutcome::Converged {
                all.outcome = step.outcome;
            }
            if matches!(step.outcome, StepOutcome::NoResponse | StepOutcome::Stalled) {
                // No bound allows this error, so that the step is made again in shorter pieces.
                return (all, f64::INFINITY);
            }
            for (way, last) in self.way.iter().zip(&last) {
                curved = curved.max((way - last as &f64).abs());
            }
            last.clone_from(&self.way);
        }
        let largest = self.state.displacement.iter().fold(0.0f64, |largest, u| largest.max(u.abs()));
        (all, if curved == 0.0 { 0.0 } else { curved / (12.0 * largest) })
    }

    fn before_step(&self) -> Before {
        let (state, ledger) = (self.state.clone(), self.ledger.clone());
        Before { state, memory: self.resistance.memory().cloned(), ledger }
    }

    fn restore(&mut self, before: &Before) {
        self.state.clone_from(&before.state);
        self.ledger.clone_from(&before.ledger);
        self.resistance.remember(before.memory.clone());
        // The forces in the trial are those of the state that was left.
        self.refresh();
    }
}
