//! The spectral objective `min_κ ‖E(κ)‖₂`, `E = R̂ − Σ_I κ_I Σ_{s∈I} h_s h_sᵀ`: the least t with `A = tI − E ⪰ 0` and `B = tI + E ⪰ 0`.
//!
//! A barrier method follows the minimisers of `t/μ − log det A − log det B − Σ log κ` (the last term only for `κ ≥ 0`)
//! to μ → 0 (Nesterov and Nemirovskii 1994). The matrices of the springs have rank one, so that the Hessian needs no
//! product of matrices: its entries are `(h_sᵀ A⁻¹ h_t)² + (h_sᵀ B⁻¹ h_t)²`.
//!
//! Any positive semidefinite X and Y with `⟨h_s h_sᵀ, X − Y⟩ = 0` bound the optimum from below by
//! `⟨R̂, X − Y⟩/(tr X + tr Y)`. A Newton step (ΔA, ΔB) of norm below one gives such a pair, `X = μ (A⁻¹ − A⁻¹ ΔA A⁻¹)`
//! and Y correspondingly; [`Spectral::bound`] checks it independently.
//!
//! Theory: page *The 2-norm* of the book.

mod ambiguity;
mod dual;
mod problem;
mod refinement;
mod side;

pub use ambiguity::least_frobenius;
pub use problem::{Optimum, Problem};
pub use refinement::refine;

use super::dense::{
    FLOOR, at_half, at_rounding, factorize, inner, least_pivot, longest_step, mirror, row_products, solve, solve_both,
    tie, trace,
};
use super::jacobi::eigenvectors;
use super::reduction::Reduced;
use crate::scalar::{Real, vectorized};
use side::ShiftedMatrix;

/// The requested duality gap, relative to t, or relative to `EXACT ‖R‖` if t is smaller. It is half of the digits of
/// `f64`; numbers of another precision use half of theirs.
pub const GAP: f64 = 1e-8;
/// Below this fraction of ‖R‖, rounding in R itself hides t: the gap relative to it is 1e-14 of ‖R‖, some fifty roundings.
pub const EXACT: f64 = 1e-6;
/// If the curvature of the barrier (see [`Spectral`]) is below this, the optimum may not be unique.
pub const AMBIGUOUS: f64 = 1e6;
/// The largest number of steps; cells of aspects up to 1000 take 94. A lane that is not at the end has the gap that its certificate tells.
const STEPS: usize = 120;
/// How often a step is halved within one iteration. Two halvings take as many steps, and with one some lanes do not end.
const SHORTER: usize = 4;
/// A step keeps at least this share of the distance to the boundary that the path would keep. Shares from 0.1 to 0.6 take as many steps.
const KEPT: f64 = 0.3;
/// A step that would lower μ by more than this share nearly always leaves the domain: its half is tried first, for a third fewer trials.
const FAR: f64 = 0.95;
/// A step goes at most this share of the way to where the first κ would be zero. A share of 0.25 takes a fifth more steps, 0.95 as many.
const TOWARDS_ZERO: f64 = 0.5;
/// Newton steps at a fixed μ have stalled if the squared decrement stays above the first number, and above the second
/// number times the previous one.
const STALLED: [f64; 2] = [1.5, 0.9];

/// The working memory of the solver, and its result.
#[derive(Debug, Clone)]
pub struct Spectral<T> {
    /// The unknowns κ, `[unknowns]`.
    pub kappa: Vec<T>,
    /// `‖E‖₂ < t`.
    pub value: T,
    /// No κ reaches a value below this.
    pub bound: T,
    /// The least curvature of the barrier over the unknowns, in units in which an unknown that does not affect t has
    /// about one, and an unknown that does has more than a million.
    pub curvature: T,
    nonnegative: bool,
    /// The gap at which the fit may end, without a refinement.
    pub gap: f64,
    e: Vec<T>,
    a: ShiftedMatrix<T>,
    b: ShiftedMatrix<T>,
    /// The Hessian of the barrier in (κ, t), and its gradient without `1/μ`.
    hessian: Vec<T>,
    gradient: Vec<T>,
    pivots: Vec<T>,
    newton: Vec<T>,
    tangent: Vec<T>,
    /// The eigenvalues of E at the end, on the diagonal, and its eigenvectors, row by row, if a lane has not reached the gap or may have
    /// several optima.
    eigenvalues: Vec<T>,
    eigenvectors: Vec<T>,
    /// The factors of the Gram matrix of the matrices of the unknowns.
    gram: Vec<T>,
    gram_pivots: Vec<T>,
    room: Vec<T>,
}

impl<T: Real> Spectral<T> {
    pub fn like(any: &T, reduced: &Reduced<T>, nonnegative: bool, gap: f64) -> Spectral<T> {
        let (p, m, c) = (reduced.order, reduced.unknowns.len(), reduced.scales.len());
        let zero = any.zero();
        let room = |size: usize| vec![zero.clone(); size];
        Spectral {
            kappa: room(c),
            value: zero.clone(),
            bound: zero.clone(),
            curvature: zero.clone(),
            nonnegative,
            gap,
            e: room(p * p),
            a: ShiftedMatrix::new(&zero, p, m),
            b: ShiftedMatrix::new(&zero, p, m),
            hessian: room((c + 1) * (c + 1)),
            gradient: room(c + 1),
            pivots: room(c + 1),
            newton: room(c + 1),
            tangent: room(c + 1),
            eigenvalues: room(p * p),
            eigenvectors: room(p * p),
            gram: room(m * m),
            gram_pivots: room(c),
            room: room((p * p).max(m * p).max((c + 1) * (c + 1))),
        }
    }

    /// The least pivot of that Gram matrix in one lane, relative to its diagonal entry.
    pub fn least_pivot(&self, lane: impl Fn(&T) -> f64) -> f64 {
        least_pivot(&self.gram, self.kappa.len(), &self.gram_pivots, lane)
    }

    /// Solves for the element in `reduced`, in every lane.
    pub fn solve(&mut self, reduced: &Reduced<T>) {
        // Numbers of more digits are for what is difficult: steps of other lengths may reach the end.
        let lengths: &[f64] = if T::epsilon() < T::given() { &[FAR, 1.0] } else { &[FAR] };
        vectorized!(self.value.clone(), _ = lengths.iter().any(|far| self.follow_path(reduced, *far)));
    }

    /// Whether every lane has reached the gap.
    #[inline(always)]
    fn is_within(&self, gap: f64) -> bool {
        let enough = self.value.greatest(&self.value.constant(&EXACT)).scaled(&gap);
        enough.exceeds(&(self.value.clone() - &self.bound))
    }

    /// Beyond the share `far` of μ, the half of a step is tried first. Returns whether every lane has reached [`GAP`].
    #[inline(always)]
    fn follow_path(&mut self, reduced: &Reduced<T>, far: f64) -> bool {
        let (p, c) = (reduced.order, self.kappa.len());
        let zero = self.value.zero();
        let one = zero.one();
        vectorized!(zero, self.start(reduced));
        let floor = one.constant(&at_half::<T>(EXACT));
        let complexity = (2 * p + if self.nonnegative { c } else { 0 }) as f64;
        let mut mu = zero.clone();
        let mut kappa = self.kappa.clone();
        // The trial step: z + α d, and μ (1 − α (1 − θ)). A first θ from 0.05 to 0.4 changes the number of steps by 3 %.
        let mut step: Vec<T> = self.newton.clone();
        for entry in &mut step {
            *entry = zero.clone();
        }
        let (mut alpha, mut reduction, mut theta) = (zero.clone(), zero.clone(), one.constant(&0.2));
        // The least distance of a trial from the boundary, and the decrement at the same μ.
        let (mut kept, mut previous) = (zero.clone(), one.constant(&f64::MAX));
        let mut first = true;
        for _ in 0..STEPS {
            // Shorten the step if it leaves the domain; lanes that are still outside continue in the next iteration.
            let (mut inside, mut distance) = (zero.clone(), zero.clone());
            for trial in 0..=SHORTER {
                if trial > 0 {
                    alpha = inside.choose(&alpha, &alpha.clone().scaled(&0.5));
                }
                distance = self.enter(reduced, &mut kappa, &alpha, &step);
                let followed = one.clone().minus_product(&alpha, &reduction);
                inside = distance.clone().minus_product(&kept, &followed);
                if inside.exceeds(&zero) {
                    break;
                }
            }
            kept = inside.choose(&distance.scaled(&KEPT), &kept);
            let t = self.value.clone().plus_product(&alpha, &step[c]);
            for i in 0..c {
                self.kappa[i] = inside.choose(&kappa[i], &self.kappa[i]);
            }
            self.value = inside.choose(&t, &self.value);
            vectorized!(zero, self.derivatives(reduced, &kappa));
            if first {
                mu = one.clone() / &self.gradient[c].negated();
                first = false;
            } else {
                let followed = mu.clone() * &(one.clone() - &(alpha.clone() * &reduction));
                mu = inside.choose(&followed, &mu);
            }
            let decrement = self.directions(&mut mu, &previous);
            // On the path the gap is μ times the complexity: at 0.4 of the gap that is asked for, a point beside the
            // path is within it as well.
            let end = self.value.greatest(&floor).scaled(&(0.4 * at_half::<T>(GAP) / complexity));
            // Centred and at the end of the path: no further change. Decrements from 0.05 to 0.8 change the number of steps by 2 %.
            let centred = one.constant(&0.2) - &decrement;
            let done = (end.clone().scaled(&1.001) - &mu).choose(&centred, &zero.clone().scaled(&-1.0));
            let done = inside.choose(&done, &(zero.clone() - &one));
            if done.exceeds(&zero) {
                break;
            }
            // Follow the path if close to it, otherwise step back to it.
            let length = one.clone() / &(one.clone() + &decrement.greatest(&zero).sqrt());
            // Next to the boundary each of the two matrices adds at most one to the decrement, and a full step doubles
            // the distance. Only beyond this number can the step be too long.
            let length = (one.constant(&complexity) - &decrement).choose(&one, &length);
            // θ follows how easy steps are. Least values of 1e-5 to 1e-2, largest ones of 0.5 to 0.95, and decrements of 0.15 to 0.9 and of
            // 0.5 to 4 between which θ stays change the number of steps by 3 % at most.
            let faster = theta.clone().squared().greatest(&one.constant(&1e-3));
            let slower = theta.clone().sqrt().least(&one.constant(&0.8));
            let next = (one.constant(&0.3) - &decrement).choose(&faster, &theta);
            let next = (decrement.clone() - &one).choose(&slower, &next);
            // Halved twice: the path is followed too fast. (If α is zero no step has been tried.) Above 0.5 one halving would count.
            let halved = (one.constant(&0.3) - &alpha).choose(&alpha, &zero);
            theta = inside.choose(&halved.choose(&slower, &next), &slower);
            let least = (end / &mu).least(&one);
            let target = (one.constant(&0.5) - &decrement).choose(&theta.greatest(&least), &one);
            let remaining = one.clone() - &target;
            let pull = remaining.clone() / &mu;
            let same = remaining.choose(&one.constant(&f64::MAX), &decrement);
            previous = inside.choose(&same, &previous);
            for i in 0..=c {
                let along = (self.newton[i].clone() * &length).minus_product(&pull, &self.tangent[i]);
                let along = done.choose(&zero, &along);
                step[i] = inside.choose(&along, &step[i]);
            }
            reduction = inside.choose(&done.choose(&zero, &remaining), &reduction);
            let beyond = remaining - &one.constant(&far);
            let whole = beyond.choose(&one.constant(&0.5), &one);
            let whole = match self.nonnegative {
                true => whole.least(&longest_step(&self.kappa, &step[..c]).scaled(&TOWARDS_ZERO)),
                false => whole,
            };
            alpha = inside.choose(&whole, &alpha.clone().scaled(&0.5));
        }
        self.measure_curvature();
        self.bound = vectorized!(zero, self.bound(reduced, &mu));
        let is_unique = self.nonnegative || self.curvature.exceeds(&one.constant(&AMBIGUOUS));
        if T::epsilon() >= T::given() && !(self.is_within(self.gap) && is_unique) {
            reduced.residual(&self.kappa, &mut self.eigenvalues);
            mirror(&mut self.eigenvalues, reduced.order);
            eigenvectors(&mut self.eigenvalues, reduced.order, &mut self.eigenvectors);
        }
        self.is_within(GAP)
    }

    /// Evaluates both matrices at the trial point, which is written to `kappa`; positive if the point is inside the domain.
    #[inline(always)]
    fn enter(&mut self, reduced: &Reduced<T>, kappa: &mut [T], alpha: &T, step: &[T]) -> T {
        let (p, c) = (reduced.order, kappa.len());
        let mut inside = alpha.one();
        for i in 0..c {
            kappa[i] = self.kappa[i].clone().plus_product(alpha, &step[i]);
            if self.nonnegative {
                inside = inside.least(&kappa[i]);
            }
        }
        let t = self.value.clone().plus_product(alpha, &step[c]);
        reduced.residual(kappa, &mut self.e);
        inside = inside.least(&self.a.set(&self.e, p, &t, -1.0));
        inside.least(&self.b.set(&self.e, p, &t, 1.0))
    }

    /// The κ of the least-squares fit, and a t above its error: factors of 1.01 to 1.5 take as many steps to 2 %.
    #[inline(always)]
    fn start(&mut self, reduced: &Reduced<T>) {
        let (p, c) = (reduced.order, self.kappa.len());
        let zero = self.value.zero();
        let h = reduced.rows();
        let m = reduced.unknowns.len();
        reduced.gram(&mut self.gram, &mut self.hessian);
        row_products(h, &reduced.stiffness[..p * p], p, false, &mut self.room[..m * p]);
        for entry in &mut self.kappa {
            *entry = zero.clone();
        }
        for (s, &unknown) in reduced.unknowns.iter().enumerate() {
            let row = s * p..(s + 1) * p;
            self.kappa[unknown] = self.kappa[unknown].clone() + &inner(&h[row.clone()], &self.room[row]);
        }
        // Kept for the correction of the bound: the Gram matrix of the matrices of the unknowns.
        self.gram[..c * c].clone_from_slice(&self.hessian[..c * c]);
        factorize(&mut self.gram[..c * c], c, at_rounding::<T>(FLOOR), &mut self.gram_pivots);
        solve(&self.gram[..c * c], c, &self.gram_pivots, &mut self.kappa);
        if self.nonnegative {
            let mut mean = zero.clone();
            for entry in &self.kappa {
                // A tenth of the mean constant: inside of the domain, and small beside what the optimum has above zero.
                mean = mean + &entry.magnitude().scaled(&(0.1 / c as f64));
            }
            for entry in &mut self.kappa {
                *entry = entry.greatest(&mean);
            }
        }
        reduced.residual(&self.kappa, &mut self.e);
        let mut square = zero.clone();
        for i in 0..p {
            for j in 0..=i {
                let entry = &self.e[i * p + j];
                let twice = entry.clone().squared().scaled(if i == j { &1.0 } else { &2.0 });
                square = square + &twice;
            }
        }
        self.value = square.sqrt().scaled(&1.05) + &zero.constant(&at_half::<T>(EXACT));
    }

    /// Gradient and Hessian of the barrier at the trial point, whose matrices are factorised.
    #[inline(always)]
    fn derivatives(&mut self, reduced: &Reduced<T>, kappa: &[T]) {
        let (p, c) = (reduced.order, self.kappa.len());
        let zero = self.value.zero();
        self.a.invert(reduced.rows(), p, &mut self.room);
        self.b.invert(reduced.rows(), p, &mut self.room);
        let width = c + 1;
        for entry in self.gradient.iter_mut().chain(&mut self.hessian[c * width..]) {
            *entry = zero.clone();
        }
        let (a, b) = (&self.a, &self.b);
        tie(
            &a.products,
            &b.products,
            &reduced.unknowns,
            c,
            width,
            &mut self.hessian,
            #[inline(always)]
            |a, b| a.clone().squared().plus_product(b, b),
        );
        let m = reduced.unknowns.len();
        for (s, &unknown) in reduced.unknowns.iter().enumerate() {
            let change = b.products[s * m + s].clone() - &a.products[s * m + s];
            self.gradient[unknown] = self.gradient[unknown].clone() + &change;
            let row = s * p..(s + 1) * p;
            let bend =
                inner(&a.images[row.clone()], &a.images[row.clone()]) - &inner(&b.images[row.clone()], &b.images[row]);
            let mixed = &mut self.hessian[c * width + unknown];
            *mixed = mixed.clone() + &bend;
        }
        self.gradient[c] = zero.clone() - &trace(&a.inverse, p) - &trace(&b.inverse, p);
        self.hessian[c * width + c] = inner(&a.inverse, &a.inverse) + &inner(&b.inverse, &b.inverse);
        if self.nonnegative {
            for i in 0..c {
                let inverse = zero.one() / &kappa[i];
                self.gradient[i] = self.gradient[i].clone() - &inverse;
                let diagonal = &mut self.hessian[i * width + i];
                *diagonal = diagonal.clone().plus_product(&inverse, &inverse);
            }
        }
    }

    /// The Newton step for this μ, and the tangent of the path, `H⁻¹ e_t`; returns the squared Newton decrement.
    ///
    /// If the steps have stalled, with a decrement hardly below the `previous` one, μ is first raised to that of the
    /// nearest point of the path: the squared decrement, `|H^-½ (g + e_t/μ)|²`, is quadratic in 1/μ.
    #[inline(always)]
    fn directions(&mut self, mu: &mut T, previous: &T) -> T {
        let c = self.kappa.len();
        let zero = mu.zero();
        for i in 0..=c {
            self.newton[i] = self.gradient[i].negated();
            self.tangent[i] = if i == c { zero.one() } else { zero.clone() };
        }
        factorize(&mut self.hessian, c + 1, at_rounding::<T>(FLOOR), &mut self.pivots);
        solve_both(&self.hessian, c + 1, &self.pivots, [&mut self.newton, &mut self.tangent]);
        let square = inner(&self.newton, &self.gradient).negated();
        let (mixed, bend) = (self.newton[c].clone(), self.tangent[c].clone());
        let pull = zero.one() / &*mu;
        // At most a hundredfold, so that a wrong curvature cannot throw μ back to the start.
        let nearest = (mixed.clone() / &bend).greatest(&pull.clone().scaled(&1e-2)).least(&pull);
        let decrement = quadratic(&square, &mixed, &bend, &pull);
        let least = previous.clone().scaled(&STALLED[1]).greatest(&mu.constant(&STALLED[0]));
        let stalled = decrement - &least;
        let pull = stalled.choose(&nearest, &pull);
        *mu = stalled.choose(&(zero.one() / &pull), mu);
        for i in 0..=c {
            self.newton[i] = self.newton[i].clone().minus_product(&pull, &self.tangent[i]);
        }
        quadratic(&square, &mixed, &bend, &pull)
    }

    /// The least ratio of the pivots of the Hessian to those of the Gram matrix, in units of `1/t²`.
    #[inline(always)]
    fn measure_curvature(&mut self) {
        let mut least = self.value.constant(&f64::MAX);
        for (gram, hessian) in self.gram_pivots.iter().zip(&self.pivots) {
            least = least.least(&(gram.clone() / hessian));
        }
        self.curvature = least * &self.value.clone().squared();
    }
}

/// `a − 2 b x + c x²`.
#[inline(always)]
fn quadratic<T: Real>(a: &T, b: &T, c: &T, x: &T) -> T {
    a.clone().plus_product(&(c.clone() * x - &b.clone().scaled(&2.0)), x)
}
