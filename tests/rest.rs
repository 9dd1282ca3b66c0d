//! Fits whose springs pull at rest, against matrices formed here entry by entry, and the identity that makes some exact.

use crate::fits::{Case, LARGE, case, cases, weights};
use crate::shapes::statics::dense;
use crate::shapes::{Random, distorted, geometry, loaded, materials};
use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Elastic, Network, RestTension};
use springfit_element::element::Element;
use springfit_element::material::Moduli;
use springfit_element::springs::{Force, Springs};
use springfit_fit::fit::{
    Balance, CellFits, Fit, Higher, MotionWeight, Objective, Rest, Search, Solver, Weight, element_errors, fit_cells,
    fit_element,
};
use springfit_foundation::error::{Error, ErrorKind};
use springfit_mesh::mesh::{BoxMesh, Mesh};
use springfit_numerics::dense::{least_squares, outer, singular};
use springfit_report::report::Report;
use springfit_studies::study::{NamedFit, Scene, run};
use std::path::Path;

/// A cell with what its springs measure at rest and the second derivatives, `[nodes·dimension × nodes·dimension]`.
struct Pulling {
    case: Case,
    measures: Vec<f64>,
    bends: Vec<DMatrix<f64>>,
}

/// An unknown: what it adds to k and T of each spring.
struct Unknown {
    terms: Vec<(usize, f64, f64)>,
    is_constant: bool,
}

impl Pulling {
    fn of(case: Case) -> Pulling {
        let (d, size) = (case.springs.dimension(), case.x.len());
        let (mut measures, mut bends) = (Vec::new(), Vec::new());
        for (nodes, measure) in case.springs.measures(&case.element) {
            let dofs: Vec<usize> = nodes.iter().flat_map(|&a| a * d..(a + 1) * d).collect();
            let at: Vec<f64> = dofs.iter().map(|&i| case.x[i]).collect();
            let jet = measure.jet(&at, d);
            let mut bend = DMatrix::zeros(size, size);
            for (i, &row) in dofs.iter().enumerate() {
                for (j, &column) in dofs.iter().enumerate() {
                    bend[(row, column)] += jet.hessian[i * dofs.len() + j];
                }
            }
            measures.push(jet.value);
            bends.push(bend);
        }
        Pulling { case, measures, bends }
    }

    fn fits(&self, fit: &Fit) -> Result<CellFits, Error> {
        let Case { element, springs, x, moduli, .. } = &self.case;
        let cell: Vec<usize> = (0..element.nodes()).collect();
        fit_cells(element, springs, x, &cell, *moduli, fit, &mut |_| {})
    }

    /// k and T.
    fn solve(&self, fit: &Fit) -> Result<(Vec<f64>, Vec<f64>), Error> {
        self.fits(fit).map(|fits| self.taken(fits))
    }

    /// k and T of a fit that has been made.
    fn taken(&self, fits: CellFits) -> (Vec<f64>, Vec<f64>) {
        let (k, count) = (&fits.constants, fits.constants.len());
        let pull = |s: usize| match fits.force {
            Force::FreeRest => k[s] * self.measures[s] - fits.parameters[s],
            Force::Linear | Force::Laws(_) | Force::Exact { .. } => 0.0,
        };
        let largest =
            |of: &dyn Fn(usize) -> f64| (0..count).map(|s| (of(s) * self.case.g[s].norm()).abs()).fold(0.0, f64::max);
        // The measures here are from the origin, those of the fit from the first node: they differ by rounding.
        let is_rounding = largest(&pull) <= 1e-13 * largest(&|s| k[s] * self.measures[s]);
        let tensions = (0..count).map(|s| if is_rounding { 0.0 } else { pull(s) }).collect();
        (fits.constants, tensions)
    }

    /// `R − K`.
    fn residual(&self, k: &[f64], t: &[f64]) -> DMatrix<f64> {
        let difference = &self.case.r - self.case.stiffness(k);
        t.iter().zip(&self.bends).filter(|(t, _)| **t != 0.0).fold(difference, |sum, (t, bend)| sum - *t * bend)
    }

    /// `‖W (R − K) W‖` and `‖W R W‖`.
    fn error(&self, weight: Weight, k: &[f64], t: &[f64]) -> (f64, f64) {
        let by = self.case.seen_by(weight);
        let seen = |a: &DMatrix<f64>| by(a).norm();
        (seen(&self.residual(k, t)), seen(&self.case.r))
    }

    /// `Σ T_s g_s`, the largest on a node, and the largest `|T_s| ‖g_s‖` of a node.
    fn forces(&self, t: &[f64]) -> (f64, f64) {
        let d = self.case.springs.dimension();
        let largest = |force: &DVector<f64>| force.as_slice().chunks_exact(d).map(norm).fold(0.0, f64::max);
        let mut sum = DVector::zeros(self.case.x.len());
        self.case.g.iter().zip(t).for_each(|(g, t)| sum += *t * g);
        (largest(&sum), self.case.g.iter().zip(t).map(|(g, t)| t.abs() * largest(g)).fold(0.0, f64::max))
    }

    /// As documented at [`Rest`]: tied springs share k and the ratio of their rest measures.
    fn unknowns(&self, rest: Rest, tied: bool) -> Vec<Unknown> {
        let springs = &self.case.springs;
        let groups: Vec<Vec<usize>> = match tied {
            true => (0..springs.names().len())
                .map(|group| (0..springs.len()).filter(|&s| springs.groups()[s] == group).collect())
                .collect(),
            false => (0..springs.len()).map(|s| vec![s]).collect(),
        };
        let mut all = Vec::new();
        for members in groups {
            let c = |s: usize| if members.len() == 1 { 1.0 } else { self.measures[s] };
            if rest == Rest::Zero && members[0] < springs.pairs().len() {
                let terms = members.iter().map(|&s| (s, 1.0, self.measures[s])).collect();
                all.push(Unknown { terms, is_constant: true });
                continue;
            }
            let of = |k: f64, t: f64| members.iter().map(|&s| (s, k, t * c(s))).collect();
            all.push(Unknown { terms: of(1.0, 0.0), is_constant: true });
            all.push(Unknown { terms: of(0.0, 1.0), is_constant: false });
        }
        all
    }

    /// The columns `W A W` and forces of the unknowns, those of the former with norm one.
    fn columns(&self, weight: Weight, unknowns: &[Unknown]) -> (DMatrix<f64>, DMatrix<f64>) {
        let size = self.case.x.len();
        let mut a = DMatrix::zeros(size * size, unknowns.len());
        let mut c = DMatrix::zeros(size, unknowns.len());
        let by = self.case.seen_by(weight);
        for (j, unknown) in unknowns.iter().enumerate() {
            let mut matrix = DMatrix::zeros(size, size);
            let mut force = DVector::zeros(size);
            for &(s, k, t) in &unknown.terms {
                let g = &self.case.g[s];
                matrix += outer(k, g);
                if t != 0.0 {
                    matrix += t * &self.bends[s];
                    force += t * g;
                }
            }
            let seen = by(&matrix);
            let scale = if seen.norm() > 0.0 { 1.0 / seen.norm() } else { 1.0 };
            a.set_column(j, &(scale * DVector::from_column_slice(seen.as_slice())));
            c.set_column(j, &(scale * force));
        }
        (a, c)
    }

    fn rhs(&self, weight: Weight) -> DVector<f64> {
        DVector::from_column_slice(self.case.weighted(weight, &self.case.r).as_slice())
    }

    /// Whether only springs of no force and no stiffness balance.
    fn is_stuck(&self, rest: Rest, tied: bool) -> bool {
        let unknowns = self.unknowns(rest, tied);
        let (_, c) = self.columns(Weight::None, &unknowns);
        let pulling: Vec<usize> = (0..unknowns.len()).filter(|&j| c.column(j).norm() > 0.0).collect();
        let c = c.select_columns(&pulling);
        let c = DMatrix::from_fn(c.nrows(), c.ncols(), |i, j| c[(i, j)] / c.column(j).norm());
        pulling.len() == unknowns.len() && c.nrows() >= c.ncols() && singular(c).unwrap().values.min() > 1e-9
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Some materials of every element at a random shape, with and without its optional springs; and of those that are not large the
/// reference shape under a linear map, where springs of a group are alike.
fn subjects() -> Vec<Pulling> {
    let some = |(i, case): &(usize, Case)| i % 3 == 0 || case.springs.len() > LARGE;
    let cases: Vec<Case> = cases(1).into_iter().enumerate().filter(some).map(|(_, case)| case).collect();
    let mut random = Random(41);
    let mapped = |of: &Case| {
        let d = of.springs.dimension();
        let map = DMatrix::from_fn(d, d, |i, j| f64::from(u8::from(i == j)) + 0.2 * random.next());
        let place = |at: &[f64]| (&map * DVector::from_column_slice(at)).as_slice().to_vec();
        let x: Vec<f64> = of.element.positions.chunks_exact(d).flat_map(place).collect();
        case(&of.element, &of.springs, &x, of.moduli)
    };
    let regular: Vec<Case> = cases.iter().filter(|case| case.springs.len() <= LARGE).map(mapped).collect();
    cases.into_iter().chain(regular).map(Pulling::of).collect()
}

/// Of large elements, whose matrices take a second to form here, two weights and no bounds.
fn is_skipped(subject: &Pulling, fit: &Fit) -> bool {
    let few = [Weight::None, Weight::OffDiagonal].map(Objective::Frobenius);
    subject.case.springs.len() > LARGE && (fit.tied || fit.nonnegative || !few.contains(&fit.objective))
}

fn frobenius(weight: Weight, rest: Rest) -> Fit {
    Fit { rest, ..Fit::new(Objective::Frobenius(weight)) }
}

/// k and T of a fit; none where it is refused because nothing is in equilibrium, which is checked.
fn solved(subject: &Pulling, fit: &Fit) -> Option<(Vec<f64>, Vec<f64>)> {
    fitted(subject, fit).map(|fits| subject.taken(fits))
}

/// The fit itself, as [`solved`] has its springs.
fn fitted(subject: &Pulling, fit: &Fit) -> Option<CellFits> {
    match subject.fits(fit) {
        Ok(found) => Some(found),
        Err(error) => {
            assert!(subject.is_stuck(fit.rest, fit.tied), "{}: {error}", subject.case.name);
            assert_eq!(error.kind(), ErrorKind::Infeasible);
            None
        }
    }
}

/// Stored are k and `k c₀`, so that a tension has the rounding of `k c`; no cell here has tensions that small.
#[test]
fn forces_at_rest_vanish_and_the_error_is_not_above_that_without_tension() {
    let (mut pulling, mut stuck) = (0, 0);
    for subject in subjects() {
        for (weight, bounds) in weights().into_iter().flat_map(|w| [0, 1, 2, 3].map(|bounds| (w, bounds))) {
            for rest in [Rest::Free, Rest::Zero] {
                let fit = Fit { nonnegative: bounds & 1 > 0, tied: bounds & 2 > 0, ..frobenius(weight, rest) };
                if is_skipped(&subject, &fit) {
                    continue;
                }
                let Some((k, t)) = solved(&subject, &fit) else {
                    stuck += 1;
                    continue;
                };
                let name = format!("{} {fit:?}", subject.case.name);
                let (left, largest) = subject.forces(&t);
                assert!(left <= 1e-10 * largest, "{name}: {left} {largest}");
                pulling += usize::from(largest > 0.0);
                assert!(!fit.nonnegative || k.iter().all(|k| *k >= 0.0), "{name}: {k:?}");
                if rest == Rest::Free {
                    let (without, _) = subject.solve(&Fit { rest: Rest::Mesh, ..fit }).unwrap();
                    let (error, size) = subject.error(weight, &k, &t);
                    let (mesh, _) = subject.error(weight, &without, &vec![0.0; t.len()]);
                    assert!(error <= mesh + 1e-9 * size, "{name}: {error} {mesh}");
                } else {
                    let lengths = subject.case.springs.pairs().len();
                    let of_zero = |s: usize| (t[s] - k[s] * subject.measures[s]).abs() <= 1e-15 * t[s].abs();
                    assert!((0..lengths).all(of_zero), "{name}");
                }
            }
        }
    }
    assert!(pulling > 500 && stuck > 50, "{pulling} {stuck}");
}

/// What tied springs share: k, and where they pull the ratio of the rest measure to that of the mesh.
#[test]
fn tied_springs_share_their_rest_ratio() {
    let mut pulling = 0;
    for subject in subjects() {
        let groups = subject.case.springs.groups();
        for rest in [Rest::Free, Rest::Zero] {
            let fit = Fit { tied: true, ..frobenius(Weight::None, rest) };
            let Some((k, t)) = solved(&subject, &fit) else { continue };
            let largest = (0..k.len()).map(|s| t[s].abs() / subject.measures[s].abs()).fold(0.0, f64::max);
            for (s, t_s) in t.iter().enumerate() {
                for other in (0..s).filter(|&other| groups[other] == groups[s]) {
                    let densities = t_s / subject.measures[s] - t[other] / subject.measures[other];
                    assert!(k[s] == k[other] && densities.abs() <= 1e-12 * largest, "{}", subject.case.name);
                    pulling += usize::from(*t_s != 0.0);
                }
            }
        }
    }
    assert!(pulling > 100, "{pulling}");
}

/// The residual is orthogonal to every change of the unknowns that keeps the equilibrium: its products with their columns are the
/// work of some displacement y against their forces. Changes that the weight hardly sees, less than 5e-7 of the others, count as
/// unseen; the cell is reported as deficient then, and a slope of that size is left, over some ten unknowns.
#[test]
fn optima_are_stationary() {
    let mut strict = 0;
    for subject in subjects() {
        for weight in weights() {
            for (rest, tied) in [(Rest::Free, false), (Rest::Free, true), (Rest::Zero, false), (Rest::Zero, true)] {
                let fit = Fit { tied, ..frobenius(weight, rest) };
                if is_skipped(&subject, &fit) {
                    continue;
                }
                let Some(fits) = fitted(&subject, &fit) else { continue };
                let is_deficient = fits.deficient > 0;
                let (k, t) = subject.taken(fits);
                let seen = subject.case.weighted(weight, &subject.residual(&k, &t));
                let (a, c) = subject.columns(weight, &subject.unknowns(rest, tied));
                let slopes = a.tr_mul(&DVector::from_column_slice(seen.as_slice()));
                let left = beyond_rows(&c, slopes).amax();
                let size = subject.rhs(weight).norm();
                // A direction that counts as dependent, below 5e-7 of the stiffest, keeps its slope.
                let most = if is_deficient { 5e-6 } else { 1e-9 };
                assert!(left <= most * size, "{} {fit:?}: {left} of {size}", subject.case.name);
                strict += usize::from(!is_deficient);
            }
        }
    }
    assert!(strict > 500, "{strict}");
}

/// What of v is no combination of the rows of C; combinations that rounding alone tells from zero count as zero. What the first subtraction
/// leaves of its rounding, the second takes away.
fn beyond_rows(c: &DMatrix<f64>, mut v: DVector<f64>) -> DVector<f64> {
    let rows = c.transpose();
    let back = singular(rows.clone()).unwrap().pseudo_inverse(1e-12);
    for _ in 0..2 {
        v -= &rows * (&back * &v);
    }
    v
}

/// Lawson and Hanson (1974), chapter 23: `min ‖b − A u‖` with `u_j ≥ 0` for the bounded, free ones always in the set.
fn nonnegative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>, bounded: &[bool]) -> DVector<f64> {
    let n = a.ncols();
    let mut inside: Vec<bool> = bounded.iter().map(|bounded| !bounded).collect();
    let solve = |inside: &[bool]| {
        let set: Vec<usize> = (0..n).filter(|&j| inside[j]).collect();
        let mut u = DVector::zeros(n);
        if !set.is_empty() {
            let found = least_squares(a.select_columns(&set), b, 1e-12).unwrap();
            set.iter().zip(found.iter()).for_each(|(&j, value)| u[j] = *value);
        }
        u
    };
    let mut u = solve(&inside);
    for _ in 0..10 * n {
        let slopes = a.tr_mul(&(b - a * &u));
        let steepest = (0..n).filter(|&j| !inside[j]).max_by(|&i, &j| slopes[i].total_cmp(&slopes[j]));
        let Some(entering) = steepest.filter(|&j| slopes[j] > 1e-10 * b.norm()) else { break };
        inside[entering] = true;
        loop {
            let next = solve(&inside);
            let wrong: Vec<usize> = (0..n).filter(|&j| bounded[j] && inside[j] && next[j] <= 0.0).collect();
            if wrong.is_empty() {
                u = next;
                break;
            }
            let way = wrong.iter().map(|&j| u[j] / (u[j] - next[j])).fold(1.0, f64::min);
            u += way * (next - &u);
            wrong.into_iter().filter(|&j| u[j] <= 1e-14).for_each(|j| inside[j] = false);
        }
    }
    u
}

/// The equilibrium as a penalty of weight ρ² makes the reference less by up to ‖y‖²/ρ², y the multipliers, of about the size of b,
/// to which forces are scaled.
#[test]
fn nonnegative_optima_are_those_of_an_active_set_method() {
    const PENALTY: f64 = 1e4;
    let mut bound = 0;
    for subject in subjects().into_iter().filter(|subject| subject.case.springs.len() <= 11) {
        for (weight, rest) in weights().into_iter().flat_map(|w| [(w, Rest::Free), (w, Rest::Zero)]) {
            let fit = Fit { nonnegative: true, ..frobenius(weight, rest) };
            let Some(fits) = fitted(&subject, &fit) else { continue };
            assert_eq!(fits.unreached, 0, "{} {fit:?}", subject.case.name);
            let (k, t) = subject.taken(fits);
            let unknowns = subject.unknowns(rest, false);
            let (a, c) = subject.columns(weight, &unknowns);
            let b = subject.rhs(weight);
            let mut rows = DMatrix::zeros(a.nrows() + c.nrows(), a.ncols());
            rows.view_mut((0, 0), a.shape()).copy_from(&a);
            rows.view_mut((a.nrows(), 0), c.shape()).copy_from(&(PENALTY / c.amax() * &c));
            let mut rhs = DVector::zeros(rows.nrows());
            rhs.rows_mut(0, b.len()).copy_from(&(&b / b.norm()));
            let bounded: Vec<bool> = unknowns.iter().map(|unknown| unknown.is_constant).collect();
            let u = nonnegative_least_squares(&rows, &rhs, &bounded);
            let reference = (rhs - rows * u).norm();
            let (error, size) = subject.error(weight, &k, &t);
            let name = format!("{} {fit:?}", subject.case.name);
            assert!((error / size - reference).abs() < 1e-5, "{name}: {} {reference}", error / size);
            bound += k.iter().filter(|k| **k == 0.0).count();
        }
    }
    assert!(bound > 50, "the bound was hardly ever active: {bound}");
}

/// With springs of rest length zero on the edges, `k_ab = −μ V ∇N_a·∇N_b`, and one on the content, the simplex of constant strain is
/// the finite element: `Σ_q w_q |F_q|² = −Σ_{a<b} L_ab |x_a − x_b|²`.
#[test]
fn zero_rest_lengths_make_simplices_exact() {
    for name in ["tri3", "tet4"] {
        let element = loaded(name);
        let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        let springs = Springs::select(&element, Some(&every)).unwrap();
        let mut random = Random(23);
        for _ in 0..40 {
            let x = distorted(&element, &mut random);
            for material in materials(element.dimension()) {
                let subject = Pulling::of(case(&element, &springs, &x, material.moduli()));
                let Moduli { mu, .. } = material.moduli();
                for weight in weights() {
                    let (k, t) = subject.solve(&frobenius(weight, Rest::Zero)).unwrap();
                    let geometry = geometry(&element, &x);
                    let d = element.dimension();
                    for (s, &[a, b]) in springs.pairs().iter().enumerate() {
                        let mut expected = 0.0;
                        for (grad, v, _) in geometry.each_point() {
                            expected -= mu * v * (0..d).map(|l| grad[a * d + l] * grad[b * d + l]).sum::<f64>();
                        }
                        assert!((k[s] - expected).abs() < 1e-11 * subject.case.r.norm(), "{name}: {} {expected}", k[s]);
                    }
                    let error = subject.residual(&k, &t).norm() / subject.case.r.norm();
                    assert!(error < 1e-12, "{name} {weight:?}: {error}");
                    // The free fit finds it as well.
                    let (k, t) = subject.solve(&frobenius(weight, Rest::Free)).unwrap();
                    let error = subject.residual(&k, &t).norm() / subject.case.r.norm();
                    assert!(error < 1e-11, "{name} {weight:?}: {error}");
                }
            }
        }
    }
}

/// A rotation leaves `k ‖g‖²` and `T ‖g‖`, a length s and a modulus E multiply them by `E s^(d−2)` and `E s^(d−1)`.
#[test]
fn springs_know_no_direction_and_no_unit() {
    let mut random = Random(31);
    for subject in subjects().into_iter().filter(|subject| subject.case.springs.len() <= 30) {
        let Case { element, springs, x, moduli, r, .. } = &subject.case;
        let d = springs.dimension();
        let mut rotation = DMatrix::from_fn(d, d, |_, _| random.next()).qr().q();
        if rotation.determinant() < 0.0 {
            rotation.column_mut(0).neg_mut();
        }
        for (young, scale, turned) in [(1.0, 1.0, true), (1e-9, 1e6, false), (1e12, 1e-6f64, false)] {
            let place = |at: &[f64]| -> Vec<f64> {
                let at = DVector::from_column_slice(at);
                if turned { (&rotation * at).as_slice().to_vec() } else { (scale * at).as_slice().to_vec() }
            };
            let moved: Vec<f64> = x.chunks_exact(d).flat_map(place).collect();
            let moduli = Moduli { lambda: young * moduli.lambda, mu: young * moduli.mu };
            let other = Pulling::of(case(element, springs, &moved, moduli));
            let factor = young * scale.powi(d as i32 - 2);
            let extent = norm(x);
            for fit in [
                frobenius(Weight::None, Rest::Free),
                frobenius(Weight::OffDiagonal, Rest::Zero),
                Fit { nonnegative: true, ..frobenius(Weight::Modal(Higher::DEFAULT), Rest::Free) },
                Fit { tied: true, ..frobenius(Weight::None, Rest::Free) },
            ] {
                let (Some((k, t)), Some((k2, t2))) = (solved(&subject, &fit), solved(&other, &fit)) else { continue };
                for s in 0..k.len() {
                    let (g, g2) = (subject.case.g[s].norm(), other.case.g[s].norm());
                    let constants = k2[s] * g2 * g2 / factor - k[s] * g * g;
                    let tensions = t2[s] * g2 / (factor * scale) - t[s] * g;
                    let name = format!("{} {fit:?} {young} {scale}", subject.case.name);
                    assert!(constants.abs() < 1e-7 * r.norm(), "{name}: {constants} of {}", r.norm());
                    assert!(tensions.abs() < 1e-7 * extent * r.norm(), "{name}: {tensions} of {}", r.norm());
                }
            }
        }
    }
}

/// A box of jittered cells with all springs that the element has.
fn body(name: &str) -> (Mesh, Springs) {
    let element = loaded(name);
    let d = element.dimension();
    let spec = BoxMesh { element: element.clone(), size: vec![0.3; d], cells: vec![2; d], origin: vec![0.1; d] };
    let mut mesh = spec.build().unwrap();
    let mut random = Random(8);
    mesh.points.iter_mut().for_each(|x| *x += 4e-3 * random.next());
    let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    (mesh, Springs::select(&element, Some(&every)).unwrap())
}

/// The network of the cells' springs balances, and its tangent is the sum of the cells'; the constants that a bound holds at zero are
/// springs of constant force, whose energy, force and tangent belong together.
#[test]
fn networks_have_the_tangent_of_their_cells() {
    let mut constant_forces = 0;
    for name in ["tri3", "quad4", "tet4", "hex8", "tri6"] {
        let (mesh, springs) = body(name);
        let (block, d) = (&mesh.blocks[0], mesh.dimension);
        let moduli = materials(d)[2].moduli();
        for (rest, nonnegative) in [(Rest::Free, false), (Rest::Free, true), (Rest::Zero, false), (Rest::Zero, true)] {
            let fit = Fit { nonnegative, ..frobenius(Weight::None, rest) };
            let element = &block.element;
            let fits =
                fit_cells(element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {}).unwrap();
            let (n, m, size) = (element.nodes(), springs.len(), mesh.points.len());
            let mut sum = DMatrix::<f64>::zeros(size, size);
            let mut largest = 0.0f64;
            for (cell, nodes) in block.cells().enumerate() {
                let x: Vec<f64> = nodes.iter().flat_map(|&p| mesh.points[p * d..(p + 1) * d].to_vec()).collect();
                let subject = Pulling::of(case(element, &springs, &x, moduli));
                let k = &fits.constants[cell * m..(cell + 1) * m];
                let t: Vec<f64> = (0..m).map(|s| k[s] * subject.measures[s] - fits.parameters[cell * m + s]).collect();
                let own = &subject.case.r - subject.residual(k, &t);
                largest = largest.max(own.norm());
                for i in 0..n * d {
                    for j in 0..n * d {
                        sum[(nodes[i / d] * d + i % d, nodes[j / d] * d + j % d)] += own[(i, j)];
                    }
                }
            }
            let name = format!("{name} {fit:?}");
            let network = Network::assemble(&mesh, std::slice::from_ref(&fits));
            let tension = RestTension::of(&network, &mesh.points);
            assert!(tension.unbalanced <= 1e-10, "{name}: {tension:?}");
            constant_forces += tension.steady;
            assert!((dense(size, &network.stiffness(&mesh.points)) - &sum).norm() < 1e-9 * largest, "{name}");
            let at_rest = network.respond(&mesh.points).unwrap();
            assert!((dense(size, &at_rest.tangent) - &sum).norm() < 1e-9 * largest, "{name}");
            // The work along a way is the difference of the energies, by Simpson's rule: a way of a thousandth, to the fifth power.
            let mut random = Random(5);
            let way: Vec<f64> = mesh.points.iter().map(|_| 1e-4 * random.next()).collect();
            let at = |share: f64| -> Vec<f64> { mesh.points.iter().zip(&way).map(|(x, u)| x + share * u).collect() };
            let power = |share: f64| {
                let force = network.respond(&at(share)).unwrap().force;
                force.iter().zip(&way).map(|(f, u)| f * u).sum::<f64>()
            };
            let work = (power(0.0) + 4.0 * power(0.5) + power(1.0)) / 6.0;
            let energy = |share: f64| network.energy(&at(share)).unwrap();
            let difference = energy(1.0) - energy(0.0);
            let rounding =
                1e-14 * network.lengths.iter().map(|s| s.pull(s.rest.abs() + 0.3)[0].abs()).fold(0.0, f64::max);
            assert!((work - difference).abs() < 1e-4 * work.abs() + rounding, "{name}: {work} {difference}");
        }
    }
    assert!(constant_forces > 10, "{constant_forces}");
}

/// Where the constants of two cells cancel, the force of their common spring does not.
#[test]
fn springs_whose_constants_cancel_keep_their_force() {
    let (mesh, springs) = body("tri3");
    let block = &mesh.blocks[0];
    let moduli = materials(2)[2].moduli();
    let fit = frobenius(Weight::None, Rest::Free);
    let (element, points, nodes) = (&block.element, &mesh.points, &block.connectivity);
    let mut fits = fit_cells(element, &springs, points, nodes, moduli, &fit, &mut |_| {}).unwrap();
    let plain = Network::assemble(&mesh, std::slice::from_ref(&fits));
    // The first spring of the first cell, taken back by an equal one of the last cell that has it, but for its force.
    let m = springs.len();
    let mut of_edge: Vec<usize> = Vec::new();
    let first = springs.pairs()[0].map(|a| nodes[a]);
    for (cell, cell_nodes) in block.cells().enumerate() {
        for (s, pair) in springs.pairs().iter().enumerate() {
            let mut ends = pair.map(|a| cell_nodes[a]);
            ends.sort_unstable();
            let mut wanted = first;
            wanted.sort_unstable();
            if ends == wanted {
                of_edge.push(cell * m + s);
            }
        }
    }
    of_edge.iter().for_each(|&s| (fits.constants[s], fits.parameters[s]) = (0.0, 0.0));
    fits.parameters[of_edge[0]] = -2.5;
    let network = Network::assemble(&mesh, std::slice::from_ref(&fits));
    assert_eq!(network.len(), plain.len());
    let steady: Vec<_> = network.others.iter().filter(|spring| spring.law.is_some()).collect();
    assert_eq!(steady.len(), 1);
    for c in [0.01, 0.1, 0.4] {
        let [_, pull, slope] = steady[0].pull(c);
        assert_eq!((pull, slope), (2.5, 0.0));
        assert!((steady[0].pull(c)[0] - 2.5 * (c - steady[0].rest)).abs() < 1e-15);
    }
}

/// What `element_errors` says is what the matrices say.
#[test]
fn errors_of_elements_count_tensions() {
    for subject in subjects().into_iter().filter(|subject| subject.case.springs.len() <= 30) {
        let fit = frobenius(Weight::None, Rest::Free);
        let Case { element, x, moduli, r, .. } = &subject.case;
        let cell: Vec<usize> = (0..element.nodes()).collect();
        let fits = subject.fits(&fit).unwrap();
        let errors = element_errors(element, x, &cell, *moduli, &fits).unwrap();
        let (k, t) = subject.solve(&fit).unwrap();
        let expected = subject.residual(&k, &t).norm() / r.norm();
        assert!((errors.frobenius[0] - expected).abs() < 1e-12, "{}", subject.case.name);
    }
}

/// A fit into the memory of another leaves nothing of it.
#[test]
fn fits_into_used_memory_are_as_new() {
    let (mesh, springs) = body("quad4");
    let block = &mesh.blocks[0];
    let moduli = materials(2)[0].moduli();
    let (element, points, nodes) = (&block.element, &mesh.points, &block.connectivity);
    let of = |rest| fit_cells(element, &springs, points, nodes, moduli, &frobenius(Weight::None, rest), &mut |_| {});
    let (plain, free) = (of(Rest::Mesh).unwrap(), of(Rest::Free).unwrap());
    let mut used = free.clone();
    used.refit(element, points, nodes, moduli, &frobenius(Weight::None, Rest::Mesh), &mut |_| {}).unwrap();
    assert_eq!(used, plain);
    used.refit(element, points, nodes, moduli, &frobenius(Weight::None, Rest::Free), &mut |_| {}).unwrap();
    assert_eq!(used, free);
}

#[test]
fn what_cannot_have_tensions_is_refused() {
    let element = loaded("tri3");
    let springs = Springs::select(&element, None).unwrap();
    let moduli = materials(2)[0].moduli();
    let refused = |fit: Fit, element: &Element, points: &[f64]| {
        let springs = Springs::select(element, None).unwrap();
        fit_cells(element, &springs, points, &[0, 1, 2], moduli, &fit, &mut |_| {}).unwrap_err()
    };
    let x = [0.0, 0.0, 1.0, 0.0, 0.2, 0.9];
    let solver = Solver::General { method: Search::NelderMead, iterations: 10, topology: None };
    for rest in [Rest::Free, Rest::Zero] {
        for fit in [
            Fit { rest, ..Fit::new(Objective::Spectral(MotionWeight::None)) },
            Fit { rest, ..Fit::new(Objective::Divergence(Balance::DEFAULT)) },
            Fit { rest, solver, ..Fit::new(Objective::Frobenius(Weight::None)) },
        ] {
            let error = refused(fit, &element, &x);
            assert_eq!(error.key(), Some("rest"), "{error}");
            assert!(error.to_string().contains(rest.name()), "{error}");
        }
        let error = fit_element(&element, &springs, &x, moduli, &frobenius(Weight::None, rest)).unwrap_err();
        assert_eq!(error.key(), Some("rest"), "{error}");
    }
    // Springs of no length on the edges alone hold each other only without force.
    let error = refused(frobenius(Weight::None, Rest::Zero), &element, &x);
    assert!(error.to_string().contains("cell 1") && error.to_string().contains("content"), "{error}");
    // Tensions also resist motions out of the plane of a surface, which its stiffness does not know.
    let error = refused(
        frobenius(Weight::None, Rest::Free),
        &Element::clone(&element).in_space(3),
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.2, 0.2, 0.9, 0.1],
    );
    assert_eq!((error.key(), error.kind()), (Some("rest"), ErrorKind::Unsupported), "{error}");
}

const PLATE: &str = r#"
[mesh]
box = { element = "tri3", size = [1, 1], cells = [3, 2] }
[material]
young = 10e3
poisson = 0.3
plane = "strain"
thickness = 0.1
[[fit]]
objective = "offdiag"
nonnegative = true
[[fit]]
objective = "modal"
springs = ["edge", "bulk"]
rest = "zero"
[[fit]]
objective = "frobenius"
springs = ["edge", "bulk"]
rest = "free"
tied = true
[[fix]]
group = "ymin"
[[load]]
group = "ymax"
traction = [0, 1]
"#;

/// The exact network moves as the finite elements do, and the report says what its springs are.
#[test]
fn scenes_with_zero_rest_lengths_are_exact_and_say_so() {
    let scene = Scene::parse(PLATE, Path::new("scene.toml")).unwrap();
    let outcome = run(&scene, &mut |_| {}).unwrap();
    let names: Vec<&str> = outcome.fits.iter().map(|fit| fit.fit.name.as_str()).collect();
    assert_eq!(names, ["offdiag k>=0", "modal 0.316 +edge +bulk zero rest", "frobenius +edge +bulk free rest tied"]);
    let exact = &outcome.fits[1];
    assert!(exact.loads[0].error.unwrap().max < 1e-9, "{:?}", exact.loads[0].error);
    let tension = exact.kind.stiffness().unwrap().tension.unwrap();
    assert_eq!((tension.network.rest_lengths.mean, tension.network.negative, tension.idle), (1.0, 0, 0));
    assert!(outcome.fits[0].kind.stiffness().unwrap().tension.is_none());
    let report = serde_json::to_value(Report::of(&outcome)).unwrap();
    let rests: Vec<&str> = (0..3).map(|i| report["fits"][i]["rest"].as_str().unwrap()).collect();
    assert_eq!(rests, ["mesh", "zero", "free"]);
    assert!(report["fits"][0]["tension"].is_null());
    assert_eq!(report["fits"][1]["tension"]["rest_lengths"]["max"], 1.0);
    assert!(report["fits"][1]["tension"]["unbalanced"].as_f64().unwrap() < 1e-10);
    assert!(exact.kind.notes(12, &outcome.material).iter().any(|note| note.contains("rest lengths")));
}

/// The title alone tells fits apart.
#[test]
fn titles_tell_the_rest_measure() {
    let title = |rest| NamedFit::new(frobenius(Weight::OffDiagonal, rest), None).name;
    assert_eq!([Rest::Mesh, Rest::Free, Rest::Zero].map(title), ["offdiag", "offdiag free rest", "offdiag zero rest"]);
}

/// Simplices without springs on content have no tension in balance but none: what is left of it is rounding, and no network out of balance.
#[test]
fn no_tension_is_no_imbalance() {
    for mesh in ["square_tri", "cube_tet"] {
        let text = format!(
            "[mesh]\nfile = {:?}\nscale = 0.01\n[material]\nyoung = 1e4\npoisson = 0.3\n{}\n[[fit]]\nobjective = \"frobenius\"\nrest = \"free\"\n",
            format!("{}/scenes/meshes/{mesh}.msh", env!("CARGO_MANIFEST_DIR")),
            if mesh == "square_tri" { "plane = \"stress\"\nthickness = 0.01" } else { "" }
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let outcome = run(&Scene::load(&path).unwrap(), &mut |_| {}).unwrap();
        let network = &outcome.fits[0].network;
        let tension = RestTension::of(network, &outcome.mesh.points);
        assert!(tension.unbalanced == 0.0 && tension.rest_lengths.max < 1e-9, "{mesh}: {tension:?}");
    }
}
