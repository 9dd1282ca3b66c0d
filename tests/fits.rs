//! The constants of every fit at random shapes of every element, against matrices formed here entry by entry.

use crate::shapes::{Random, distorted, elements, geometry, materials, rigid_motions};
use nalgebra::{DMatrix, DVector};
use num_rational::BigRational;
use springfit_element::element::Element;
use springfit_element::material::{Hooke, Material, Moduli, Stiffness};
use springfit_element::springs::Springs;
use springfit_fit::fit::{
    Balance, CellFits, Fit, Higher, MotionWeight, Objective, Weight, constants_in, fit_cells, fit_element,
    reference_fit,
};
use springfit_mesh::mesh::BoxMesh;
use springfit_numerics::dense::{eigen, eigenvalues, inverse, product};
use springfit_studies::study::FitEntry;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Every weight; of the modal ones the default and that of no weight.
pub fn weights() -> Vec<Weight> {
    Weight::all().chain([Weight::Modal(Higher::new(1.0).unwrap())]).collect()
}

/// Springs of an element that counts as large.
pub const LARGE: usize = 40;

/// R and the rows g_s of one element.
pub struct Case {
    pub name: String,
    pub element: Arc<Element>,
    pub springs: Springs,
    pub x: Vec<f64>,
    /// The moduli of the law, where it is isotropic; other cases have none that mean anything.
    pub moduli: Moduli,
    /// The law that is fitted.
    hooke: Hooke,
    pub r: DMatrix<f64>,
    pub g: Vec<DVector<f64>>,
    /// W of the relative weight, and the projection on the linear motions, once they are asked for.
    relative: OnceLock<DMatrix<f64>>,
    linear: OnceLock<DMatrix<f64>>,
}

pub fn case(element: &Arc<Element>, springs: &Springs, x: &[f64], moduli: Moduli) -> Case {
    let geometry = geometry(element, x);
    let mut rows = Vec::new();
    springs.gradients(x, &geometry, &mut rows);
    let g = rows.chunks_exact(x.len()).map(DVector::from_column_slice).collect();
    let name = format!("{} with {} springs", element.name, springs.len());
    let r = geometry.stiffness(moduli);
    Case {
        name,
        element: element.clone(),
        springs: springs.clone(),
        x: x.to_vec(),
        moduli,
        hooke: moduli.into(),
        r,
        g,
        relative: OnceLock::new(),
        linear: OnceLock::new(),
    }
}

/// Every element, with and without its optional springs, at random shapes, for every material.
pub fn cases(shapes: usize) -> Vec<Case> {
    let mut all = Vec::new();
    for element in elements().into_iter().map(Arc::new) {
        let mut random = Random(11);
        let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        for springs in [None, Some(&every[..])].map(|names| Springs::select(&element, names).unwrap()) {
            // Of large elements, whose matrices take a second to form here, one shape of one material.
            let large = springs.len() > LARGE;
            for _ in 0..if large { 1 } else { shapes } {
                let x = distorted(&element, &mut random);
                let of = |material: Material| case(&element, &springs, &x, material.moduli());
                let first = if large { 2..3 } else { 0..usize::MAX };
                let materials = materials(element.dimension()).into_iter().enumerate();
                all.extend(materials.filter(|(i, _)| first.contains(i)).map(|(_, material)| of(material)));
            }
        }
    }
    all
}

/// `Σ_q v Bᵀ D B` with B written out, in the order xx, yy, zz, yz, xz, xy.
fn integrated(element: &Element, x: &[f64], d: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, dim) = (element.nodes(), element.dimension());
    let geometry = geometry(element, x);
    let rows: &[(usize, usize)] = match dim {
        1 => &[(0, 0)],
        2 => &[(0, 0), (1, 1), (0, 1)],
        _ => &[(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)],
    };
    let mut r = DMatrix::zeros(n * dim, n * dim);
    for (gradients, v) in geometry.gradients.chunks(n * dim).zip(&geometry.volumes) {
        let mut b = DMatrix::zeros(rows.len(), n * dim);
        for (row, &(k, l)) in rows.iter().enumerate() {
            for a in 0..n {
                b[(row, a * dim + k)] += gradients[a * dim + l];
                if k != l {
                    b[(row, a * dim + l)] += gradients[a * dim + k];
                }
            }
        }
        r += b.transpose() * d * b * *v;
    }
    r
}

/// Every element that one rule integrates, at a random shape, with a random anisotropic stiffness.
fn anisotropic() -> Vec<Case> {
    let mut random = Random(23);
    let of = |element: Element| {
        let (d, x) = (element.dimension(), distorted(&element, &mut random));
        let a = DMatrix::from_fn(d * (d + 1) / 2, d * (d + 1) / 2, |_, _| random.next());
        let given = &a * a.transpose() * 1e3 + DMatrix::identity(a.nrows(), a.nrows()) * 50.0;
        let (springs, element) = (Springs::select(&element, None).unwrap(), Arc::new(element));
        let r = integrated(&element, &x, &given);
        let hooke = Hooke::Anisotropic(Stiffness::new(d, given.as_slice()).unwrap());
        let own = geometry(&element, &x).stiffness(&hooke);
        assert!((own - &r).norm() < 1e-11 * r.norm(), "{}", element.name);
        let name = format!("anisotropic {}", element.name);
        Case { name, hooke, r, ..case(&element, &springs, &x, Moduli { lambda: 0.0, mu: 1.0 }) }
    };
    let is_one_rule = |element: &Element| element.tabulation.volumetric.is_empty();
    let all: Vec<Case> = elements().into_iter().filter(is_one_rule).map(of).collect();
    assert!(all.len() > 10, "{}", all.len());
    all
}

impl Case {
    fn fit(&self, fit: Fit) -> Vec<f64> {
        fit_element(&self.element, &self.springs, &self.x, self.hooke.clone(), &fit).unwrap()
    }

    /// `K = Σ k_s g_s g_sᵀ`, by one product of matrices.
    pub fn stiffness(&self, k: &[f64]) -> DMatrix<f64> {
        let scaled: Vec<DVector<f64>> = self.g.iter().zip(k).map(|(g, k)| g * *k).collect();
        product(&DMatrix::from_columns(&self.g), &DMatrix::from_columns(&scaled).transpose())
    }

    /// `W A W`, or A without its diagonal blocks.
    pub fn weighted(&self, weight: Weight, a: &DMatrix<f64>) -> DMatrix<f64> {
        self.seen_by(weight)(a)
    }

    /// The function that gives [`Case::weighted`] of any matrix. It forms W once.
    pub fn seen_by(&self, weight: Weight) -> impl Fn(&DMatrix<f64>) -> DMatrix<f64> + use<> {
        let (d, w) = (self.springs.dimension(), self.weighing(weight));
        move |a| match &w {
            Some(w) => product(&product(w, a), w),
            None if weight == Weight::OffDiagonal => {
                DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| if i / d == j / d { 0.0 } else { a[(i, j)] })
            }
            None => a.clone(),
        }
    }

    /// W; the constant-strain motions here from an orthonormal basis.
    fn weighing(&self, weight: Weight) -> Option<DMatrix<f64>> {
        let (d, n) = (self.springs.dimension(), self.springs.nodes());
        match weight {
            Weight::None | Weight::OffDiagonal => None,
            Weight::Modal(higher) => {
                // All linear motions u_a = e_k x_al, translations among them: C Cᵀ is their projection on a matrix that
                // vanishes on the rigid ones.
                let form = || {
                    let linear = DMatrix::from_fn(n * d, d * (d + 1), |row, column| {
                        let (a, k, l) = (row / d, column % d, column / d);
                        let place = if l == d { 1.0 } else { self.x[a * d + l] };
                        if row % d == k { place } else { 0.0 }
                    });
                    let basis = linear.qr().q();
                    product(&basis, &basis.transpose())
                };
                let projection = self.linear.get_or_init(form);
                let identity = DMatrix::identity(n * d, n * d);
                Some(projection + higher.value() * (identity - projection))
            }
            Weight::Relative => {
                let form = || {
                    let eigen = eigen(self.r.clone());
                    let root = |e: f64| if e > 1e-9 * self.r.norm() { 1.0 / e.sqrt() } else { 0.0 };
                    let roots = DMatrix::from_diagonal(&eigen.eigenvalues.map(root));
                    &eigen.eigenvectors * roots * eigen.eigenvectors.transpose()
                };
                Some(self.relative.get_or_init(form).clone())
            }
        }
    }

    /// The gradient of `½‖R − K(k)‖²` in k: `−⟨g_s g_sᵀ, R − K⟩`, and its scale.
    fn slopes(&self, weight: Weight, k: &[f64]) -> (Vec<f64>, f64) {
        let g = DMatrix::from_columns(&self.g);
        let difference = &self.r - &g * DMatrix::from_fn(k.len(), g.nrows(), |s, i| k[s] * g[(i, s)]);
        let seen = self.weighted(weight, &difference);
        let rows = self.weighing(weight).map_or_else(|| g.clone(), |w| w * &g);
        let images = &seen * &rows;
        // In the scaling where every spring's matrix has norm one; without the diagonal blocks some of it is missing.
        let d = self.springs.dimension();
        let norm = |s: usize| {
            let blocks: Vec<f64> =
                (0..rows.nrows() / d).map(|a| rows.view((a * d, s), (d, 1)).norm_squared()).collect();
            let missing = if weight == Weight::OffDiagonal { blocks.iter().map(|b| b * b).sum() } else { 0.0 };
            (blocks.iter().sum::<f64>().powi(2) - missing).sqrt()
        };
        let slopes = (0..k.len()).map(|s| -rows.column(s).dot(&images.column(s)) / norm(s)).collect();
        (slopes, self.weighted(weight, &self.r).norm())
    }

    /// Constants in the scaling where every g has norm one.
    fn normalised<'a>(&'a self, k: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        k.iter().zip(&self.g).map(|(k, g)| k * g.norm_squared())
    }
}

/// Rounding, multiplied by the condition of the equations (up to 1e4 with the content spring): 1e-10 of ‖R‖.
const ROUNDING: f64 = 1e-10;

#[test]
fn the_residual_is_orthogonal_to_every_spring() {
    for case in cases(5).into_iter().chain(anisotropic()) {
        for weight in weights() {
            let k = case.fit(Fit::new(Objective::Frobenius(weight)));
            let (slopes, scale) = case.slopes(weight, &k);
            slopes.iter().for_each(|s| assert!(s.abs() < ROUNDING * scale, "{} {weight:?}: {s}", case.name));
        }
    }
}

#[test]
fn nonnegative_constants_satisfy_the_optimality_conditions() {
    let mut bound = 0;
    for case in cases(5).into_iter().chain(anisotropic()) {
        for weight in weights() {
            let k = case.fit(Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(weight)) });
            let (slopes, scale) = case.slopes(weight, &k);
            for (slope, &k) in slopes.iter().zip(&k) {
                assert!(k >= 0.0 && *slope > -ROUNDING * scale, "{} {weight:?}: {k} {slope}", case.name);
                assert!(k == 0.0 || slope.abs() < ROUNDING * scale, "{} {weight:?}: {k} {slope}", case.name);
                bound += usize::from(k == 0.0 && case.hooke.moduli().is_some());
            }
        }
    }
    assert!(bound > 100, "the bound was hardly ever active");
}

/// Cells that are fitted side by side in lanes, some of which have no constant to bound: to the last bit what each gives alone.
#[test]
fn bounded_constants_do_not_depend_on_the_cells_beside() {
    let mut bound = 0;
    for element in elements() {
        let mut random = Random(12);
        let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        let (cells, nodes) = (11, element.nodes());
        let points: Vec<f64> = (0..cells).flat_map(|_| distorted(&element, &mut random)).collect();
        let connectivity: Vec<usize> = (0..cells * nodes).collect();
        let moduli = materials(element.dimension())[0].moduli();
        for springs in [None, Some(&every[..])].map(|names| Springs::select(&element, names).unwrap()) {
            let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::None)) };
            let of = |connectivity: &[usize]| {
                fit_cells(&element, &springs, &points, connectivity, moduli, &fit, &mut |_| {}).unwrap().constants
            };
            let together = of(&connectivity);
            for (own, nodes) in together.chunks_exact(springs.len()).zip(connectivity.chunks_exact(nodes)) {
                assert_eq!(own, of(nodes), "{} with {} springs", element.name, springs.len());
            }
            bound += usize::from(springs.len() > LARGE && together.contains(&0.0));
        }
    }
    assert!(bound > 5, "the bound was active in {bound} elements with many springs");
}

#[test]
fn tied_constants_are_equal_and_optimal_in_sum() {
    for case in cases(5) {
        for weight in weights() {
            let k = case.fit(Fit { tied: true, ..Fit::new(Objective::Frobenius(weight)) });
            let groups = case.springs.groups();
            assert!((0..k.len()).all(|s| (0..s).all(|t| groups[s] != groups[t] || k[s] == k[t])), "{}", case.name);
            // All springs of a group are of one kind, and length springs have matrices of one norm without a weight.
            if let Weight::None | Weight::OffDiagonal = weight {
                let (slopes, scale) = case.slopes(weight, &k);
                for group in 0..case.springs.names().len() {
                    let sum: f64 = slopes.iter().zip(groups).filter(|(_, g)| **g == group).map(|(s, _)| s).sum();
                    assert!(sum.abs() < ROUNDING * scale, "{} {weight:?}: {sum}", case.name);
                }
            }
        }
    }
}

#[test]
fn length_springs_off_the_diagonal_are_minus_n_r_n() {
    for case in cases(5).iter().filter(|case| case.springs.content().is_none()) {
        let d = case.springs.dimension();
        let k = case.fit(Fit::new(Objective::Frobenius(Weight::OffDiagonal)));
        for ((k, g), &[i, j]) in k.iter().zip(&case.g).zip(case.springs.pairs()) {
            let n = g.rows(j * d, d);
            let expected = -(n.transpose() * case.r.view((i * d, j * d), (d, d)) * n)[(0, 0)];
            assert!((k - expected).abs() < 1e-13 * case.r.norm(), "{}: {k} {expected}", case.name);
        }
    }
}

/// The stiffness is linear in the moduli, so that the constants are too: a power of two passes bit for bit.
#[test]
fn constants_are_linear_in_the_moduli() {
    for case in cases(2) {
        for weight in weights().into_iter().filter(|weight| *weight != Weight::Relative) {
            let of = |lambda: f64, mu: f64| {
                let fit = Fit::new(Objective::Frobenius(weight));
                fit_element(&case.element, &case.springs, &case.x, Moduli { lambda, mu }, &fit).unwrap()
            };
            let Moduli { lambda, mu } = case.moduli;
            let whole = of(lambda, mu);
            assert!(of(4.0 * lambda, 4.0 * mu).iter().zip(&whole).all(|(four, one)| *four == 4.0 * one));
            // With twice the shear modulus, which is stable where lambda alone is not.
            let (both, shear) = (of(lambda, 2.0 * mu), of(0.0, mu));
            let sum: Vec<f64> = both.iter().zip(&shear).map(|(a, b)| a - b).collect();
            for (sum, whole) in case.normalised(&sum).zip(case.normalised(&whole)) {
                assert!((sum - whole).abs() < ROUNDING * case.r.norm(), "{} {weight:?}: {sum} {whole}", case.name);
            }
        }
    }
}

/// The kernels in exact rationals give the same constants. Elimination of 28 springs would take minutes: few springs.
#[test]
fn exact_rationals_agree() {
    for case in cases(1).iter().filter(|case| case.springs.len() < 8) {
        for weight in weights().into_iter().filter(|weight| *weight != Weight::Relative) {
            let exact: Vec<BigRational> = constants_in(
                weight,
                &case.springs,
                &case.element.tabulation.map(|v| BigRational::from_float(*v).unwrap()),
                &case.x.iter().map(|x| BigRational::from_float(*x).unwrap()).collect::<Vec<_>>(),
                &Moduli {
                    lambda: BigRational::from_float(case.moduli.lambda).unwrap(),
                    mu: BigRational::from_float(case.moduli.mu).unwrap(),
                },
            )
            .unwrap();
            let exact: Vec<f64> = exact.iter().map(|k| num_traits::ToPrimitive::to_f64(k).unwrap()).collect();
            let k = case.fit(Fit::new(Objective::Frobenius(weight)));
            for (k, exact) in case.normalised(&k).zip(case.normalised(&exact)) {
                assert!((k - exact).abs() < ROUNDING * case.r.norm(), "{} {weight:?}: {k} {exact}", case.name);
            }
        }
    }
}

/// The kernels in f32, whose rounding is 6e-8: times the condition of length springs (below 1e3) and a few operations.
#[test]
fn single_precision_agrees_to_its_rounding() {
    for case in cases(3).iter().filter(|case| case.springs.content().is_none()) {
        for weight in [Weight::None, Weight::OffDiagonal] {
            let x: Vec<f32> = case.x.iter().map(|x| *x as f32).collect();
            let single = constants_in(weight, &case.springs, &case.element.tabulation, &x, &case.moduli).unwrap();
            let k = case.fit(Fit::new(Objective::Frobenius(weight)));
            for (single, k) in single.iter().zip(&k) {
                assert!((f64::from(*single) - k).abs() < 1e-4 * case.r.norm(), "{}: {single} {k}", case.name);
            }
        }
    }
}

impl Case {
    fn certified(&self, fit: Fit) -> CellFits {
        let cell: Vec<usize> = (0..self.element.nodes()).collect();
        fit_cells(&self.element, &self.springs, &self.x, &cell, self.hooke.clone(), &fit, &mut |_| {}).unwrap()
    }

    /// `‖W (R − K(k)) W‖₂`, weight none or modal.
    fn largest_eigenvalue(&self, weight: Weight, k: &[f64]) -> f64 {
        eigenvalues(self.weighted(weight, &(&self.r - self.stiffness(k)))).amax()
    }
}

const SPECTRAL: [MotionWeight; 2] = [MotionWeight::None, MotionWeight::Modal(Higher::DEFAULT)];

/// The value is that of the constants, and nothing near or far does better than the bound.
#[test]
fn spectral_optima_are_certified() {
    let mut random = Random(17);
    let mut gaps = Vec::new();
    for case in cases(4).into_iter().chain(anisotropic()) {
        for (weight, nonnegative, tied) in
            SPECTRAL.into_iter().flat_map(|w| [(w, false, false), (w, true, false), (w, false, true), (w, true, true)])
        {
            if case.springs.len() > LARGE && nonnegative != (weight != MotionWeight::None) {
                continue;
            }
            let fit = Fit { nonnegative, tied, ..Fit::new(Objective::Spectral(weight)) };
            let fits = case.certified(fit);
            let certificate = fits.certificates[0];
            let name = format!("{} {weight:?} nonnegative {nonnegative} tied {tied}", case.name);
            assert!(certificate.gap() <= 1e-8 && fits.unreached == 0, "{name}: {certificate:?}");
            // A barrier alone leaves 4e-9. That of an exact fit is relative to the rounding of R.
            let is_exact = certificate.value < 1e-5 * case.r.norm();
            assert!(is_exact || nonnegative || certificate.gap() < 1e-10, "{name}: {certificate:?}");
            if nonnegative && !is_exact {
                gaps.push(certificate.gap());
            }
            let value = case.largest_eigenvalue(weight.into(), &fits.constants);
            // R and K are computed to about 1e-15 ‖R‖ here and there.
            let rounding = 1e-13 * case.r.norm();
            assert!(value <= certificate.value + rounding, "{name}: {value} {certificate:?}");
            assert!(value >= certificate.bound - rounding, "{name}: {value} {certificate:?}");
            assert!(!nonnegative || fits.constants.iter().all(|k| *k >= 0.0), "{name}");
            let least_squares = case.fit(Fit { nonnegative, tied, ..Fit::new(Objective::Frobenius(weight.into())) });
            assert!(case.largest_eigenvalue(weight.into(), &least_squares) >= certificate.bound - rounding, "{name}");
            if !nonnegative && !tied {
                // Constants of zero move as far as others.
                let largest = fits.constants.iter().fold(0.0f64, |largest, k| largest.max(k.abs()));
                for size in [1e-6, 1e-4, 1e-3, 1e-2, 0.1] {
                    let near: Vec<f64> = fits.constants.iter().map(|k| k + size * largest * random.next()).collect();
                    assert!(case.largest_eigenvalue(weight.into(), &near) >= certificate.bound - rounding, "{name}");
                }
            }
        }
    }
    // Constants that are as good as zero may hide which are.
    gaps.sort_by(f64::total_cmp);
    let most = gaps[gaps.len() * 19 / 20];
    assert!(most < 1e-10, "{most:e}");
}

/// A fit that may end at a gap ends there with its proof, and differs from the best by no more.
#[test]
fn spectral_fits_end_at_the_gap_that_is_asked_for() {
    let (mut early, mut all) = (0, 0);
    for case in cases(2).into_iter().filter(|case| case.springs.len() <= LARGE) {
        for (weight, nonnegative) in SPECTRAL.into_iter().flat_map(|w| [(w, false), (w, true)]) {
            let best = Fit { nonnegative, ..Fit::new(Objective::Spectral(weight)) };
            let [best, ended] = [0.0, 1e-8].map(|gap| case.certified(Fit { gap, ..best }).certificates[0]);
            let name = format!("{} {weight:?} nonnegative {nonnegative}: {best:?} {ended:?}", case.name);
            assert!(ended.gap() <= 1e-8 + ended.rounding(), "{name}");
            let least = 1e-6 * case.r.norm();
            assert!((ended.value - best.value).abs() <= 1.1e-8 * best.value.max(least), "{name}");
            (early, all) = (early + usize::from(ended.gap() > 1e-10), all + 1);
        }
    }
    assert!(2 * early > all, "{early} of {all} ended before they were refined");
}

#[test]
fn gaps_are_checked() {
    let spectral = Fit::new(Objective::Spectral(MotionWeight::None));
    for gap in [-1e-9, 2e-8, f64::NAN, f64::INFINITY] {
        let error = Fit { gap, ..spectral }.check_gap().unwrap_err().to_string();
        assert!(error.contains("gap: expected a number from 0 to 1e-8"), "{error}");
    }
    let other = Fit { gap: 1e-8, ..Fit::new(Objective::Frobenius(Weight::None)) };
    assert_eq!(other.check_gap().unwrap_err(), other.check_proofs().unwrap_err());
    // The key is refused with its default value, too.
    let entry = FitEntry::new("frobenius").with("gap", Some(0.0));
    assert!(entry.fits(Path::new("")).unwrap_err().to_string().starts_with("gap: belongs to"));
    let error = other.check_gap().unwrap_err().to_string();
    assert!(error.contains("gap: belongs to objective = \"spectral\""), "{error}");
}

/// With weight `relative` the value ε is dimensionless, and `(1 − ε) R ⪯ K ⪯ (1 + ε) R`.
#[test]
fn relative_spectral_fits_bound_the_energy() {
    for case in cases(4) {
        let fits = case.certified(Fit::new(Objective::Spectral(MotionWeight::Relative)));
        let epsilon = fits.certificates[0].value;
        let k = case.stiffness(&fits.constants);
        for side in [&k - (1.0 - epsilon) * &case.r, (1.0 + epsilon) * &case.r - &k] {
            assert!(eigenvalues(side).min() > -1e-11 * case.r.norm(), "{}: {epsilon}", case.name);
        }
    }
}

/// Squares and cubes have optima that are not unique. Among them the least Frobenius error decides: nothing on the way to
/// the least-squares constants, as long as it keeps the value, has less.
#[test]
fn ambiguous_optima_have_the_least_frobenius_error() {
    let mut ambiguous = 0;
    for element in elements().into_iter().map(Arc::new) {
        let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        let springs = Springs::select(&element, Some(&every)).unwrap();
        for material in materials(element.dimension()) {
            let case = case(&element, &springs, &element.positions, material.moduli());
            let fits = case.certified(Fit::new(Objective::Spectral(MotionWeight::None)));
            let certificate = fits.certificates[0];
            if !certificate.ambiguous {
                continue;
            }
            ambiguous += 1;
            let error = |k: &[f64]| (&case.r - case.stiffness(k)).norm();
            assert!(case.largest_eigenvalue(Weight::None, &fits.constants) <= certificate.value * (1.0 + 1e-12));
            let target = case.fit(Fit::new(Objective::Frobenius(Weight::None)));
            let found = error(&fits.constants);
            for way in (1..20).map(|i| f64::from(i) / 20.0) {
                let k: Vec<f64> = fits.constants.iter().zip(&target).map(|(a, b)| a + way * (b - a)).collect();
                let kept = case.largest_eigenvalue(Weight::None, &k) <= certificate.value;
                assert!(!kept || error(&k) >= found * (1.0 - 1e-6), "{}", case.name);
            }
        }
    }
    assert!(ambiguous > 3, "nearly every optimum was unique");
}

/// Newton's method stops where the gradient vanishes: `h·h − (1 − c) h·A⁻¹h − c h·A⁻²h`, in terms of R and K as
/// `tr R⁺G − (1 − c) tr K⁺G − c tr K⁺RK⁺G`, G = g gᵀ.
#[test]
fn divergences_are_stationary() {
    for case in cases(4) {
        for balance in [0.0, 0.25, 1.0] {
            let fits = case.certified(Fit::new(Objective::Divergence(Balance::new(balance).unwrap())));
            assert_eq!(fits.unreached, 0, "{}", case.name);
            let k = case.stiffness(&fits.constants);
            // On the deformations: rigid motions get a stiffness of their own, which no g sees.
            let motions: Vec<_> =
                rigid_motions(&case.x, case.springs.dimension()).into_iter().map(DVector::from_vec).collect();
            let z = DMatrix::from_columns(&motions).qr().q();
            let held = case.r.norm() * product(&z, &z.transpose());
            let inverse = |a: &DMatrix<f64>| inverse(a + &held).unwrap();
            let (r, k) = (inverse(&case.r), inverse(&k));
            let within = product(&product(&k, &case.r), &k);
            for g in &case.g {
                let terms = [g.dot(&(&r * g)), g.dot(&(&k * g)), g.dot(&(&within * g))];
                let slope = terms[0] - (1.0 - balance) * terms[1] - balance * terms[2];
                assert!(slope.abs() < 1e-7 * terms[0].max(terms[1]), "{} {balance}: {slope} {terms:?}", case.name);
            }
        }
    }
}

/// Two pairs of triangles behind one of a metre: those of 10 nm differ by a ten-thousandth, those of 100 000 km are of unlike shapes.
#[test]
fn cells_of_unlike_sizes_do_not_take_each_others_constants() {
    let element = Element::linear_simplex(2).unwrap();
    let springs = Springs::select(&element, None).unwrap();
    let moduli = Material::for_body(2, 1e4, 0.3, None, None).unwrap().moduli();
    let legs = [[1.0, 1.0], [1e-8, 1e-8], [1e-8, 1.00005e-8], [1e8, 1e8], [1e8, 2e8]];
    let corners = |[a, b]: [f64; 2]| [0.0, 0.0, a, 0.0, 0.0, b];
    let points: Vec<f64> = legs.into_iter().flat_map(corners).collect();
    let connectivity: Vec<usize> = (0..3 * legs.len()).collect();
    let fit = Fit::new(Objective::Spectral(MotionWeight::None));
    let fits = fit_cells(&element, &springs, &points, &connectivity, moduli, &fit, &mut |_| {}).unwrap();
    assert_eq!(fits.reused, 0);
    for (legs, found) in legs.into_iter().zip(fits.constants.chunks(springs.len())) {
        let alone = fit_element(&element, &springs, &corners(legs), moduli, &fit).unwrap();
        // Two runs of one solver on the same numbers.
        assert!(
            found.iter().zip(&alone).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs()),
            "{legs:?}: {found:?} {alone:?}"
        );
    }
}

/// Cells of a regular box are of one shape (or few, where a box is cut into simplices), those of a jittered one are not; what
/// is taken over is what a fit of each cell alone gives, to the rounding of their positions.
#[test]
fn congruent_cells_are_fitted_once() {
    for element in elements().into_iter().map(Arc::new) {
        let d = element.dimension();
        let side = if element.nodes() > 10 { 2 } else { 3 };
        let spec = BoxMesh { element: element.clone(), size: vec![0.3; d], cells: vec![side; d], origin: vec![0.1; d] };
        let Ok(mut mesh) = spec.build() else { continue };
        let springs = Springs::select(&element, None).unwrap();
        let moduli = materials(d)[2].moduli();
        for objective in [Objective::Spectral(MotionWeight::None), Objective::Divergence(Balance::DEFAULT)] {
            let fit = Fit::new(objective);
            let nodes = mesh.blocks[0].connectivity.clone();
            let fits = fit_cells(&element, &springs, &mesh.points, &nodes, moduli, &fit, &mut |_| {}).unwrap();
            let cells = mesh.cell_count();
            assert!(fits.reused >= cells / 2, "{}: {} of {cells}", element.name, fits.reused);
            for (cell, nodes) in nodes.chunks_exact(element.nodes()).enumerate().step_by(cells / 4) {
                let alone = fit_cells(&element, &springs, &mesh.points, nodes, moduli, &fit, &mut |_| {}).unwrap();
                let shared = &fits.constants[cell * springs.len()..(cell + 1) * springs.len()];
                let size = shared.iter().fold(0.0f64, |a, k| a.max(k.abs()));
                for (a, b) in shared.iter().zip(&alone.constants) {
                    // Flat optimum: the root of the gap.
                    assert!((a - b).abs() < 1e-3 * size, "{}: {a} {b}", element.name);
                }
            }
        }
        let mut random = Random(8);
        mesh.points.iter_mut().for_each(|x| *x += 1e-3 * random.next());
        let fit = Fit::new(Objective::Spectral(MotionWeight::None));
        let nodes = &mesh.blocks[0].connectivity;
        let fits = fit_cells(&element, &springs, &mesh.points, nodes, moduli, &fit, &mut |_| {}).unwrap();
        assert_eq!(fits.reused, 0, "{}", element.name);
    }
}

/// The routes of a fit against its formula, written out: networks are equal in what a norm sees of them. The formula solves normal equations
/// without corrections, and loses their condition.
#[test]
fn every_route_comes_to_the_constants_of_the_formula() {
    let mut worst = 0.0f64;
    for case in cases(3) {
        let hooke = Hooke::Isotropic(case.moduli);
        let r = reference_fit::stiffness(&case.element, &case.x, &hooke).unwrap();
        assert!((&r - &case.r).norm() < 1e-13 * case.r.norm(), "{}", case.name);
        let g = DMatrix::from_columns(&case.g);
        for weight in weights() {
            let seen = reference_fit::seen(weight, &r, &case.x, case.springs.dimension());
            assert!((seen(&r) - case.weighted(weight, &r)).norm() < 1e-9 * seen(&r).norm(), "{} {weight:?}", case.name);
            let formula = reference_fit::constants(&case.element, &case.springs, &case.x, &hooke, weight).unwrap();
            let k = case.fit(Fit::new(Objective::Frobenius(weight)));
            let change: Vec<f64> = k.iter().zip(&formula).map(|(a, b)| a - b).collect();
            let difference = seen(&reference_fit::network(&g, &change)).norm() / seen(&r).norm();
            worst = worst.max(difference);
            assert!(difference < 1e-9, "{} {weight:?}: {difference}", case.name);
        }
    }
    println!("largest difference: {worst:.1e} of |R|");
}
