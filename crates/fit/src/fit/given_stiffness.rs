//! Springs for a stiffness matrix from elsewhere: of a shell, of an element of displacements and pressures, of a condensed superelement.
//!
//! The fits are those of elements: they need R and the directions of the springs alone. Theory: page *Least squares* of the book.

use super::constrained::solve_nonnegative;
use super::input::{check_finite, check_length};
use super::method::{Certificate, Method};
use super::normal::{Normal, Rank};
use super::objective::Objective;
use super::reduction::Source;
use super::reference_fit;
use super::settings::Fit;
use super::weight::Weight;
use crate::error::{Error, ErrorKind, Result};
use crate::number::first_not_finite;
use crate::scalar::DoubleDouble;
use crate::springs::{Springs, cross, distance, norm};
use nalgebra::{DMatrix, DVector};

/// A matrix is symmetric, and vanishes on rigid motions, up to this share of it: what files of eight digits leave, and what condensation does.
const PROVED: f64 = 1e-7;
/// Points this far from a line, relative to its length, are on it. The resistance of the matrix to a rotation about the
/// line has the square of this share, which is below rounding.
const STRAIGHT: f64 = 1e-9;
/// Springs up to which closed forms, and what does not reach its accuracy otherwise, are solved in double-double numbers: those of 28 nodes.
const PRECISE: usize = 400;

/// A stiffness on the displacements of some points, proved to be one.
#[derive(Debug, Clone)]
pub struct GivenStiffness {
    matrix: DMatrix<f64>,
    points: Vec<f64>,
    dimension: usize,
}

/// The springs of a stiffness.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GivenFit {
    /// The constants, `[springs]`, N/m.
    pub constants: Vec<f64>,
    /// `‖R − K‖/‖R‖` in the Frobenius norm.
    pub frobenius: f64,
    /// `‖R − K‖/‖R‖` in the induced 2-norm.
    pub spectral: f64,
    /// Whether the constants are the only ones with this objective; otherwise they are the smallest.
    pub is_unique: bool,
    /// Whether the search of an objective without a closed form has reached the accuracy that it is asked for.
    pub reached: bool,
    /// The proved gap of a spectral fit, relative to its value.
    pub gap: Option<f64>,
}

/// `R_kk − R_kc R_cc⁻¹ R_ck`: the stiffness of the degrees of freedom `kept`, in their order, where no force acts on the others; `matrix` is
/// `[order × order]`. It takes rotations out of a shell, pressures out of an element of displacements and pressures, and inner points out
/// of a superelement.
///
/// # Errors
/// The matrix is not square or not finite, a degree of freedom is not in it or kept twice; or the others have no stiffness of their own: kind
/// `Infeasible`.
pub fn condense(matrix: &DMatrix<f64>, kept: &[usize]) -> Result<DMatrix<f64>> {
    let order = check_square(matrix)?;
    let mut is_kept = vec![false; order];
    for (place, &dof) in kept.iter().enumerate() {
        let key = || format!("displacements[{place}]");
        match is_kept.get_mut(dof) {
            None => return Err(Error::expected(key(), format!("a row of the matrix, from 0 to {}", order - 1), dof)),
            Some(true) => return Err(Error::expected(key(), "each row once", format!("row {dof} twice"))),
            Some(kept) => *kept = true,
        }
    }
    let others: Vec<usize> = (0..order).filter(|dof| !is_kept[*dof]).collect();
    let block = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], columns[j])])
    };
    let own = block(kept, kept);
    if others.is_empty() {
        return Ok(own);
    }
    let inner = block(&others, &others);
    let size = inner.amax();
    let solved = inner.lu().solve(&block(&others, kept)).filter(|x| size > 0.0 && x.iter().all(|x| x.is_finite()));
    let solved = solved.ok_or_else(|| {
        let expected = "degrees of freedom beside the displacements that the matrix determines";
        Error::expected("matrix", expected, "some without stiffness").of_kind(ErrorKind::Infeasible)
    })?;
    Ok(own - block(kept, &others) * solved)
}

fn check_square(matrix: &DMatrix<f64>) -> Result<usize> {
    let (rows, columns) = matrix.shape();
    if rows != columns || rows == 0 {
        return Err(Error::expected("matrix", "a square matrix", format!("one of {rows} x {columns}")));
    }
    match first_not_finite(matrix.as_slice()) {
        Some(at) => {
            let (row, column) = (at % rows, at / rows);
            Err(Error::expected(format!("matrix[{row}][{column}]"), "a finite number", matrix[(row, column)]))
        }
        None => Ok(rows),
    }
}

impl GivenStiffness {
    /// A stiffness R, `[points·dimension × points·dimension]`, N/m, on points at these positions, `[points × dimension]`, m. Row
    /// `point · dimension + direction` has the forces of that displacement.
    ///
    /// # Errors
    /// A size is wrong or a number is not finite; R is not symmetric (key `symmetry`); or R has forces under a rigid motion (key
    /// `rigid motions`), which no springs have.
    pub fn new(matrix: DMatrix<f64>, points: Vec<f64>, dimension: usize) -> Result<GivenStiffness> {
        if !(1..=3).contains(&dimension) {
            return Err(Error::expected("points", "one, two or three coordinates of each point", dimension));
        }
        check_finite("points", &points)?;
        let order = check_square(&matrix)?;
        if points.len() < 2 * dimension || !points.len().is_multiple_of(dimension) {
            return Err(Error::expected("points", "two points or more", points.len() / dimension));
        }
        if order != points.len() {
            let count = points.len() / dimension;
            let expected = format!(
                "{} rows, {dimension} of each of {count} points; others are condensed where the rows of the displacements are given",
                points.len()
            );
            return Err(Error::expected("matrix", expected, order));
        }
        let given = GivenStiffness { matrix, points, dimension };
        given.prove()?;
        let symmetric = (&given.matrix + given.matrix.transpose()) * 0.5;
        Ok(GivenStiffness { matrix: symmetric, ..given })
    }

    fn prove(&self) -> Result<()> {
        let (r, size) = (&self.matrix, self.matrix.norm());
        if !(size > 0.0) {
            return Err(Error::expected("matrix", "a stiffness", "zeros"));
        }
        // The sum of the eigenvalues: constants of springs are scaled by it.
        let trace = r.trace();
        if !(trace > 0.0) {
            let found = format!("{trace:e}, as of a matrix whose sign is turned round");
            return Err(Error::expected("matrix", "a stiffness whose diagonal has a sum above zero", found));
        }
        let skew = (r - r.transpose()) * 0.5;
        if !(skew.norm() <= PROVED * size) {
            let at = skew
                .abs()
                .iter()
                .enumerate()
                .fold((0, 0.0), |most: (usize, f64), (at, x)| if *x > most.1 { (at, *x) } else { most })
                .0;
            let at = (at % r.nrows(), at / r.nrows());
            let found =
                format!("R[{}][{}] = {:e} and R[{}][{}] = {:e}", at.0, at.1, r[at], at.1, at.0, r[(at.1, at.0)]);
            return Err(Error::expected("symmetry", "R = Rᵀ", found)
                .followed_by(format!("; |R - R^T|/2|R| = {:.1e}", skew.norm() / size)));
        }
        for (name, motion) in self.rigid_motions() {
            let force = r * &motion;
            if !(force.norm() <= PROVED * size) {
                let found = format!("|R u| = {:.1e} |R| |u| under {name}", force.norm() / size);
                return Err(Error::expected(
                    "rigid motions",
                    "a matrix that has no forces where all points move as a rigid body",
                    found,
                )
                .followed_by(
                    "; springs have none: is the order of the rows that of the points, is a support in the matrix?",
                ));
            }
        }
        Ok(())
    }

    /// The rigid motions by name, each of length one, relative to the centre of the points.
    fn rigid_motions(&self) -> Vec<(String, DVector<f64>)> {
        let (d, n) = (self.dimension, self.points.len() / self.dimension);
        let axes = ["x", "y", "z"];
        let centre: Vec<f64> = (0..d).map(|k| self.points.iter().skip(k).step_by(d).sum::<f64>() / n as f64).collect();
        // About the centre rotations of points far from the origin are no translations up to rounding.
        let at = |p: usize, k: usize| self.points[p * d + k] - centre[k];
        let mut motions: Vec<(String, DVector<f64>)> = (0..d)
            .map(|k| {
                let motion = DVector::from_fn(n * d, |dof, _| if dof % d == k { 1.0 } else { 0.0 });
                (format!("a translation along {}", axes[k]), motion)
            })
            .collect();
        for (k, l) in (0..d).flat_map(|k| (k + 1..d).map(move |l| (k, l))) {
            let turned = DVector::from_fn(n * d, |dof, _| match dof % d {
                axis if axis == k => -at(dof / d, l),
                axis if axis == l => at(dof / d, k),
                _ => 0.0,
            });
            motions.push((format!("a rotation in the plane of {} and {}", axes[k], axes[l]), turned));
        }
        // A rotation about the line on which all points are moves none of them.
        motions.into_iter().filter(|(_, u)| u.norm() > 0.0).map(|(name, u)| (name, u.normalize())).collect()
    }

    /// All pairs of the points.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        let n = self.points.len() / self.dimension;
        (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b])).collect()
    }

    /// R, made symmetric.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// The constants of springs between these pairs of points that minimise the objective, as for an element. Springs do not pull at rest.
    ///
    /// # Errors
    /// A pair is not two points at different places; or the objective is the divergence and R meets no resistance in some motion that is not
    /// rigid, or the constants are not finite: kind `Infeasible`.
    pub fn fit(&self, pairs: &[[usize; 2]], fit: &Fit) -> Result<GivenFit> {
        let (d, n) = (self.dimension, self.points.len() / self.dimension);
        fit.check()?;
        fit.check_constants_alone()?;
        if pairs.is_empty() {
            return Err(Error::expected("springs", "at least one pair of points", "none"));
        }
        for (s, pair) in pairs.iter().enumerate() {
            let key = format!("springs[{s}]");
            if let Some(p) = pair.iter().find(|p| **p >= n) {
                return Err(Error::expected(key, format!("points from 0 to {}", n - 1), p));
            }
            let [a, b] = pair.map(|p| &self.points[p * d..(p + 1) * d]);
            if distance(a, b) == 0.0 {
                return Err(Error::expected(
                    key,
                    "two points at different places",
                    format!("points {} and {}", pair[0], pair[1]),
                ));
            }
        }
        let springs = Springs::between(pairs.to_vec(), n, d);
        let mut constants = vec![0.0; pairs.len()];
        let (rank, reached, certificate) = match fit.objective {
            Objective::Frobenius(Weight::OffDiagonal) => self.off_diagonal(&springs, fit, &mut constants),
            _ => self.reduced(&springs, fit, &mut constants)?,
        };
        if constants.iter().any(|k| !k.is_finite()) {
            let expected = "a matrix whose objective has an optimum";
            return Err(Error::expected("objective", expected, fit.objective.name()).of_kind(ErrorKind::Infeasible));
        }
        let rest = &self.matrix - reference_fit::network(&self.gradients(pairs), &constants);
        let largest = |a: &DMatrix<f64>| springfit_numerics::dense::eigenvalues(a.clone()).amax();
        Ok(GivenFit {
            frobenius: rest.norm() / self.matrix.norm(),
            spectral: largest(&rest) / largest(&self.matrix),
            is_unique: rank == Rank::Full && !certificate.is_some_and(|c| c.ambiguous),
            reached: reached && rank != Rank::Unsolved,
            gap: certificate.map(|certificate| certificate.gap()),
            constants,
        })
    }

    /// The columns g_s, `[points·dimension × springs]`.
    fn gradients(&self, pairs: &[[usize; 2]]) -> DMatrix<f64> {
        let d = self.dimension;
        let mut g = DMatrix::zeros(self.points.len(), pairs.len());
        for (s, &[i, j]) in pairs.iter().enumerate() {
            let [a, b] = [i, j].map(|p| &self.points[p * d..(p + 1) * d]);
            let length = distance(a, b);
            for k in 0..d {
                let n = (b[k] - a[k]) / length;
                g[(i * d + k, s)] -= n;
                g[(j * d + k, s)] += n;
            }
        }
        g
    }

    /// `M_st = (g_s·g_t)² − Σ_a (g_sa·g_ta)²`, `b_s = g_sᵀ R g_s − Σ_a g_saᵀ R_aa g_sa`: two springs meet in a block of different points only if
    /// they join the same two, so that M is diagonal.
    fn off_diagonal(&self, springs: &Springs, fit: &Fit, constants: &mut [f64]) -> (Rank, bool, Option<Certificate>) {
        let (d, m) = (self.dimension, springs.len());
        let pairs = springs.pairs();
        let direction = |[i, j]: [usize; 2]| {
            let [a, b] = [i, j].map(|p| &self.points[p * d..(p + 1) * d]);
            let length = distance(a, b);
            DVector::from_iterator(d, a.iter().zip(b).map(|(a, b)| (b - a) / length))
        };
        let mut normal = Normal::new(vec![0.0; m * m], vec![0.0; m]);
        for (s, &[i, j]) in pairs.iter().enumerate() {
            let n = direction([i, j]);
            let block = self.matrix.view((i * d, j * d), (d, d));
            // A spring has two blocks beside the diagonal, each `−k n nᵀ`.
            normal.rhs[s] = -2.0 * n.dot(&(block * &n));
            normal.gram[s * m + s] = 2.0;
        }
        for &(s, t) in springs.parallel() {
            normal.gram[t * m + s] = 2.0;
        }
        let (k, rank) = if fit.nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        constants.copy_from_slice(&k);
        (rank, true, None)
    }

    /// Whether the points are on a line in space, which does not turn about itself.
    fn is_straight(&self) -> bool {
        let d = self.dimension;
        let at = |p: usize| -> [f64; 3] { std::array::from_fn(|k| self.points[p * 3 + k] - self.points[k]) };
        // In the plane a line turns about the normal, a motion that moves its points.
        if d < 3 {
            return false;
        }
        let far = (1..self.points.len() / 3).map(at).max_by(|a, b| norm(a).total_cmp(&norm(b))).unwrap_or_default();
        // The product is the length times the distance from the line, so that the bound is a share of the length.
        (1..self.points.len() / 3).all(|p| norm(&cross(far, at(p))) <= STRAIGHT * norm(&far).powi(2))
    }

    /// `M_st = (g_s·g_t)²`, `b_s = g_sᵀ R g_s`.
    fn straight(
        &self,
        springs: &Springs,
        fit: &Fit,
        constants: &mut [f64],
    ) -> Result<(Rank, bool, Option<Certificate>)> {
        if fit.objective != Objective::Frobenius(Weight::None) {
            let expected = "frobenius without a weight, or offdiag, of points on a line in space";
            let error = Error::expected("objective", expected, fit.objective.title());
            return Err(error.of_kind(ErrorKind::Unsupported));
        }
        let g = self.gradients(springs.pairs());
        let gram = g.tr_mul(&g).map(|product| product * product);
        let rhs = g.column_iter().map(|g| g.dot(&(&self.matrix * g))).collect();
        let normal = Normal::new(gram.as_slice().to_vec(), rhs);
        let (k, rank) = if fit.nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        constants.copy_from_slice(&k);
        Ok((rank, true, None))
    }

    fn reduced(
        &self,
        springs: &Springs,
        fit: &Fit,
        constants: &mut [f64],
    ) -> Result<(Rank, bool, Option<Certificate>)> {
        let weight = fit.objective.of_motions()?;
        if self.is_straight() {
            return self.straight(springs, fit, constants);
        }
        // Relative to the first point, so that points far from the origin lose no digits.
        let d = self.dimension;
        let x: Vec<f64> = self.points.iter().enumerate().map(|(at, x)| x - self.points[at % d]).collect();
        // Rows first; R is symmetric.
        let r = self.matrix.as_slice();
        check_length("matrix", r.len(), x.len() * x.len())?;
        let independent = || true;
        let mut plainly = || {
            let mut method = Method::weighted(&0.0, springs, fit, weight);
            method.solve(springs, &x, Source::Matrix(r), &[]);
            method.finish_alone(independent, constants)
        };
        let is_closed = matches!(fit.objective, Objective::Frobenius(_));
        let found = if is_closed && springs.len() <= PRECISE { None } else { Some(plainly()) };
        let verdict = match found {
            Some(found) if found.reached || springs.len() > PRECISE => found,
            _ => {
                let many =
                    |values: &[f64]| -> Vec<DoubleDouble> { values.iter().map(|x| DoubleDouble::from(*x)).collect() };
                let mut method = Method::weighted(&DoubleDouble::from(0.0), springs, fit, weight);
                method.solve(springs, &many(&x), Source::Matrix(&many(r)), &[]);
                method.finish_alone(independent, constants)
            }
        };
        Ok((verdict.rank, verdict.reached, verdict.certificate))
    }
}
