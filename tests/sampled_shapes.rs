//! The shapes of a sampled fit: what each family deforms, how designs fill their ranges, sets with weights, and shapes that are held out.

use crate::messages::reads;
use crate::shapes::{Random, distorted, loaded};
use nalgebra::{DMatrix, Matrix3, Vector3};
use springfit_element::material::{Energy, Material, Plane};
use springfit_element::springs::Springs;
use springfit_element::stiffness::{EnergyFunction, Hyperelastic, StressFunction};
use springfit_fit::fit::{
    DeformationFamily, Design, Part, SampledFit, SampledFits, Sampling, Source, Weights, fit_sampled,
};
use springfit_foundation::error::Result;
use springfit_foundation::random::{Latin, Sobol};
use springfit_numerics::dense::{Singular, singular};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

/// A neo-Hookean material with E = 1, ν = 0.3 that keeps every F that it is asked for.
#[derive(Debug, Default)]
struct Recorder(Mutex<Vec<Matrix3<f64>>>);

impl StressFunction for Recorder {
    fn stresses(&self, f: &[[f64; 9]], stresses: &mut [[f64; 9]]) -> Result<()> {
        let (lambda, mu) = (0.3 / 1.3 / 0.4, 0.5 / 1.3);
        for (f, stress) in f.iter().zip(stresses) {
            let f = Matrix3::from_row_slice(f);
            let inverse = f.try_inverse().unwrap().transpose();
            let p = mu * (f - inverse) + lambda * f.determinant().ln() * inverse;
            *stress = std::array::from_fn(|i| p[(i / 3, i % 3)]);
            self.0.lock().unwrap().push(f);
        }
        Ok(())
    }
}

/// The F of a tetrahedron at each shape of the fit, in their order.
fn gradients(sampling: Sampling) -> Vec<Matrix3<f64>> {
    let element = loaded("tet4");
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(3, 1.0, 0.3, None, None).unwrap();
    let recorder = Arc::new(Recorder::default());
    let energy = EnergyFunction::new("own", material, recorder.clone()).unwrap();
    recorder.0.lock().unwrap().clear();
    let sampling = Sampling { held_out: 0, perturbation: 0.0, ..sampling };
    let fit = SampledFit { sampling, ..SampledFit::default() };
    let x = distorted(&element, &mut Random(4));
    fit_sampled(&element, &springs, &x, &[0, 1, 2, 3], &energy, material.state(), &fit, &mut |_| {}).unwrap();
    recorder.0.lock().unwrap().clone()
}

fn of_families(families: &[DeformationFamily]) -> Sampling {
    Sampling { source: Source::Families(families.to_vec()), shapes: 64, stretch: [-0.2, 0.4], ..Sampling::default() }
}

/// The amplitude a of a ratio `1 + a`, or `1/(1 − a)`.
fn amplitude(ratio: f64) -> f64 {
    if ratio < 1.0 { 1.0 - 1.0 / ratio } else { ratio - 1.0 }
}

fn within(value: f64) -> bool {
    (-0.2 - 1e-12..=0.4 + 1e-12).contains(&value)
}

fn near(f: &Matrix3<f64>, expected: &Matrix3<f64>) {
    // Rounding of the positions of a distorted cell.
    assert!((f - expected).norm() < 1e-12, "{f} {expected}");
}

/// With given axes every family is the F of its definition, whose one or two amplitudes are in the range.
#[test]
fn families_are_their_definitions_along_given_directions() {
    let (e, f) = (Vector3::new(1.0, 2.0, -2.0) / 3.0, Vector3::new(2.0, 1.0, 2.0) / 3.0);
    let directions = vec![vec![1.0, 2.0, -2.0, 2.0, 1.0, 2.0]];
    let (ee, ff) = (e * e.transpose(), f * f.transpose());
    let nn = Matrix3::identity() - ee - ff;
    for family in [
        DeformationFamily::Uniaxial,
        DeformationFamily::Equibiaxial,
        DeformationFamily::Biaxial,
        DeformationFamily::SimpleShear,
        DeformationFamily::PureShear,
    ] {
        let found = gradients(Sampling { directions: directions.clone(), ..of_families(&[family]) });
        assert_eq!(found.len(), 64);
        let mut seen = BTreeSet::new();
        for g in found {
            let [along, over] = [e.dot(&(g * e)), f.dot(&(g * f))];
            let expected = match family {
                DeformationFamily::Uniaxial => along * ee + along.powf(-0.3) * (ff + nn),
                // The axis is across the plane.
                DeformationFamily::Equibiaxial => over.powf(-0.6 / 0.7) * ee + over * (ff + nn),
                DeformationFamily::Biaxial => along * ee + over * ff + (along * over).powf(-0.3 / 0.7) * nn,
                DeformationFamily::PureShear => along * ee + 1.0 / along * ff + nn,
                _ => Matrix3::identity() + e.dot(&(g * f)) * e * f.transpose(),
            };
            near(&g, &expected);
            let own = match family {
                DeformationFamily::Equibiaxial => amplitude(over),
                DeformationFamily::SimpleShear => e.dot(&(g * f)),
                _ => amplitude(along),
            };
            assert!(within(own) && (family != DeformationFamily::Biaxial || within(amplitude(over))), "{own}");
            seen.insert((own * 1e9) as i64);
        }
        assert_eq!(seen.len(), 64, "{}", family.name());
    }
}

/// Directions take turns, and without a second one the axis across is random: a shear slides along the given one.
#[test]
fn directions_take_turns() {
    let directions = vec![vec![2.0, 0.0, 0.0], vec![0.0, 0.0, 1.0]];
    let families = [DeformationFamily::SimpleShear, DeformationFamily::Volumetric];
    let found = gradients(Sampling { directions, ..of_families(&families) });
    let mut normals = Vec::new();
    for (i, g) in found.iter().enumerate().step_by(2) {
        // Shapes 0, 4, 8, … are the shear's first, third, …: they have the first direction.
        let along = if i % 4 == 0 { 0 } else { 2 };
        let slide = g - Matrix3::identity();
        let other = (0..3).filter(|k| *k != along).map(|k| slide.row(k).norm()).fold(0.0, f64::max);
        assert!(other < 1e-12 && slide[(along, along)].abs() < 1e-12, "{i}: {slide}");
        if along == 0 {
            normals.push(f64::atan2(slide[(0, 2)], slide[(0, 1)]));
        }
    }
    // All quarters of the circle are met.
    let quarters: BTreeSet<i64> =
        normals.iter().map(|angle| (angle / std::f64::consts::FRAC_PI_2).floor() as i64).collect();
    assert_eq!(quarters.len(), 4, "{normals:?}");
}

/// Principal stretches are independent and in the range, and rotations before and after them are independent of each other.
#[test]
fn principal_stretches_have_rotations_on_both_sides() {
    let found = gradients(Sampling { shapes: 512, ..of_families(&[DeformationFamily::PrincipalStretches]) });
    let (mut left, mut right, mut both) = (Matrix3::zeros(), Matrix3::zeros(), 0.0);
    let mut all = Vec::new();
    for g in &found {
        let own = decomposed(g);
        assert!(own.values.iter().all(|ratio| within(amplitude(*ratio))), "{}", own.values);
        assert!(g.determinant() > 0.0);
        all.extend(own.values.iter().copied());
        let (q, r) = (own.scaled.column(0).normalize(), own.v.column(0));
        let [q, r] = [q.as_slice(), r.as_slice()].map(Vector3::from_column_slice);
        left += q * q.transpose() / 512.0;
        right += r * r.transpose() / 512.0;
        both += q.dot(&r).powi(2) / 512.0;
    }
    // Even directions have the mean of I/3, and two independent ones the mean square cosine 1/3; 512 of them have it to a few percent.
    for mean in [left, right] {
        assert!((mean - Matrix3::identity() / 3.0).norm() < 0.08, "{mean}");
    }
    assert!((both - 1.0 / 3.0).abs() < 0.05, "{both}");
    let mean = all.iter().map(|ratio| amplitude(*ratio)).sum::<f64>() / all.len() as f64;
    assert!((mean - 0.1).abs() < 0.02, "{mean}");
}

/// The principal stretches of a deformation gradient, and their directions.
fn decomposed(g: &Matrix3<f64>) -> Singular {
    singular(DMatrix::from_fn(3, 3, |i, k| g[(i, k)])).unwrap()
}

/// Of n shapes of a family, a Latin hypercube and a Sobol design have one in each nth of the range; random numbers do not.
#[test]
fn designs_fill_the_range_of_every_family() {
    let families = [DeformationFamily::Volumetric, DeformationFamily::Uniaxial, DeformationFamily::PureShear];
    let slices = |design: Design, shapes: usize, family: usize| {
        let found = gradients(Sampling { design, shapes, ..of_families(&families) });
        let own = found.iter().skip(family).step_by(families.len());
        let share = |g: &Matrix3<f64>| {
            let stretches = decomposed(g).values;
            let (largest, smallest) = (stretches[0], stretches[2]);
            // The stretch of an axis is the one that is not that of contraction.
            let ratio = match family {
                0 => largest,
                1 if (largest.ln() + smallest.ln()) > 0.0 => largest,
                1 => smallest,
                _ => largest,
            };
            (amplitude(ratio) + 0.2) / 0.6
        };
        let count = own.clone().count();
        let slices: BTreeSet<usize> = own.map(|g| (share(g) * count as f64) as usize).collect();
        (slices.len(), count)
    };
    for shapes in [96, 50] {
        for family in 0..2 {
            let (filled, count) = slices(Design::Latin, shapes, family);
            assert_eq!(filled, count, "{shapes} {family}");
        }
    }
    for family in 0..2 {
        assert_eq!(slices(Design::Sobol, 96, family), (32, 32), "{family}");
        let (filled, count) = slices(Design::Random, 96, family);
        // 32 balls fall into 20 of 32 boxes on average.
        assert!(filled < count - 3, "{filled}");
    }
}

/// The points of a design are those of its sequence, without those before; Latin hypercubes are permutations of every length.
#[test]
fn points_are_known_without_those_before() {
    let mut sobol = Sobol::new(5, Some(3));
    let whole = sobol.clone();
    for index in 0..100 {
        let point = sobol.point();
        assert!((0..5).all(|k| point[k] == whole.at(index, k)));
    }
    for count in [1, 2, 3, 7, 64, 100, 1000] {
        for seed in [0, 1, u64::MAX] {
            let latin = Latin::new(count, seed);
            for coordinate in 0..3 {
                let slices: BTreeSet<usize> =
                    (0..count).map(|i| (latin.at(i, coordinate) * count as f64) as usize).collect();
                assert_eq!(slices, (0..count).collect(), "{count} {seed} {coordinate}");
            }
        }
    }
}

/// The first n shapes of a longer sequence are those of a sequence of n; a Latin hypercube is laid over the longer one.
#[test]
fn the_first_shapes_are_those_of_a_longer_sequence() {
    for design in Design::all() {
        let sampling = Sampling { design, ..of_families(&[DeformationFamily::Gradients, DeformationFamily::Biaxial]) };
        let long = gradients(Sampling { shapes: 60, ..sampling.clone() });
        let short = gradients(Sampling { shapes: 17, laid: Some(60), ..sampling });
        assert_eq!(long[..17], short[..], "{}", design.name());
    }
}

fn fitted(name: &str, fit: &SampledFit) -> Result<SampledFits> {
    let element = loaded(name);
    let springs = Springs::select(&element, None).unwrap();
    let plane = (element.dimension() == 2).then_some(Plane::Strain);
    let material = Material::for_body(element.dimension(), 1.0, 0.3, plane, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let x = distorted(&element, &mut Random(4));
    let cells: Vec<usize> = (0..element.nodes()).collect();
    fit_sampled(&element, &springs, &x, &cells, &energy as &dyn Hyperelastic, material.state(), fit, &mut |_| {})
}

fn listed(list: &[[f64; 4]]) -> Sampling {
    let source = Source::Gradients(Arc::new(list.concat()));
    Sampling { source, shapes: list.len(), held_out: list.len(), perturbation: 0.0, ..Sampling::default() }
}

/// Two sets with the weights a and b minimise `a E₁² + b E₂²`, with E the error of each set, whatever the number of its shapes: fits of other
/// weights have more of it.
#[test]
fn sets_count_by_their_weights() {
    let pulled: Vec<[f64; 4]> = (1..=40).map(|i| [1.0 + 0.01 * f64::from(i), 0.0, 0.0, 1.0]).collect();
    let sheared: Vec<[f64; 4]> = (1..=9).map(|i| [1.0, 0.04 * f64::from(i), 0.0, 1.0 - 0.01 * f64::from(i)]).collect();
    let set = |list: &[[f64; 4]], weight: f64| {
        let others = Some(Box::new(listed(list)));
        Sampling { weight, others, ..listed(list) }
    };
    let errors = |a: f64, b: f64| {
        let (sampling, beside) = (set(&pulled, a), vec![set(&sheared, b)]);
        let fit = SampledFit { sampling, beside, weights: Weights::Relative, data: true, ..SampledFit::default() };
        let found = fitted("quad4", &fit).unwrap();
        let of = |set: usize| {
            let own = found.errors.iter().filter(|one| one.part == Part::HeldOut && one.set == set);
            let squares: Vec<f64> = own.map(|one| one.error.powi(2)).collect();
            assert_eq!(squares.len(), if set == 0 { 40 } else { 9 });
            squares.iter().sum::<f64>() / squares.len() as f64
        };
        let squares = [of(0), of(1)];
        let whole = ((a * squares[0] + b * squares[1]) / (a + b)).sqrt();
        // All shapes are held out as they are fitted.
        assert!((found.trained[0] - whole).abs() < 1e-12 && (found.held_out[0] - whole).abs() < 1e-12);
        (squares, found.fits.constants)
    };
    let ([first, second], own) = errors(1.0, 3.0);
    for (a, b) in [(1.0, 1.0), (3.0, 1.0), (1.0, 9.0), (2.0, 5.0)] {
        let ([other_first, other_second], _) = errors(a, b);
        assert!(first + 3.0 * second < other_first + 3.0 * other_second - 1e-12, "{a} {b}");
    }
    // Only the ratio of weights matters, and a set that has all of the weight is alone.
    assert!(own.iter().zip(&errors(20.0, 60.0).1).all(|(k, other)| (k - other).abs() < 1e-12));
    let others = Some(Box::new(listed(&pulled)));
    let sampling = Sampling { others, ..listed(&pulled) };
    let alone = fitted("quad4", &SampledFit { sampling, weights: Weights::Relative, ..SampledFit::default() }).unwrap();
    let most = errors(1e10, 1.0).1;
    assert!(alone.fits.constants.iter().zip(&most).all(|(k, other)| (k - other).abs() < 1e-6), "{most:?}");
}

/// Shapes of other families and of larger stretches are held out in place of the set's own; their errors are kept by family, and the fit does
/// not see them.
#[test]
fn other_families_and_larger_stretches_are_held_out() {
    let others = Sampling {
        source: Source::Families(vec![DeformationFamily::Bending, DeformationFamily::PrincipalStretches]),
        stretch: [0.5, 0.8],
        shapes: 31,
        ..Sampling::default()
    };
    let own = Sampling { source: Source::Families(vec![DeformationFamily::Uniaxial]), ..Sampling::default() };
    let with = |others: Option<Sampling>| {
        let sampling = Sampling { others: others.map(Box::new), ..own.clone() };
        fitted("hex8", &SampledFit { sampling, weights: Weights::Relative, data: true, ..SampledFit::default() })
            .unwrap()
    };
    let (found, usual) = (with(Some(others)), with(None));
    assert_eq!(found.fits.constants, usual.fits.constants);
    assert_eq!(found.trained, usual.trained);
    let names: Vec<(&str, usize)> = found.families.iter().map(|family| (family.family, family.shapes)).collect();
    assert_eq!(names, [("bending", 16), ("principal-stretches", 15)]);
    assert_eq!((usual.families[0].family, usual.families[0].shapes), ("uniaxial", 100));
    assert_eq!(usual.families[0].errors, usual.held_out);
    // Every principal stretch is 1.5 to 1.8, but for displacements of nodes by a twentieth of the cell.
    let stretched = found.errors.iter().filter(|one| one.family == "principal-stretches");
    assert!(
        stretched.clone().count() == 15 && stretched.clone().all(|one| one.stretches[0] > 1.2 && one.content > 2.0)
    );
    // The error is the root mean square of those of the shapes; that of a family is that of its own.
    let mean = |errors: Vec<f64>| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let of = |family: Option<&str>| {
        let own = found.errors.iter().filter(|one| one.part == Part::HeldOut && family.is_none_or(|f| f == one.family));
        mean(own.map(|one| one.error).collect())
    };
    assert!((of(None) - found.held_out[0]).abs() < 1e-12);
    for family in &found.families {
        assert!((of(Some(family.family)) - family.errors[0]).abs() < 1e-12);
    }
    let trained = found.errors.iter().filter(|one| one.part == Part::Trained).map(|one| one.error).collect();
    assert!((mean(trained) - found.trained[0]).abs() < 1e-12);
    assert!(found.held_out[0] > usual.held_out[0], "an extrapolation is worse here");
}

/// All rows of a list are fitted where other shapes are held out.
#[test]
fn lists_with_other_shapes_held_out_are_fitted_whole() {
    let list: Vec<[f64; 4]> = (0..10).map(|i| [1.1 + 0.01 * i as f64, 0.05, -0.02, 0.95]).collect();
    let with = |list: &[[f64; 4]]| {
        let others = Some(Box::new(of_families(&[DeformationFamily::Bending])));
        let fit = SampledFit { sampling: Sampling { others, ..listed(list) }, ..SampledFit::default() };
        fitted("tri3", &fit).unwrap()
    };
    let before = with(&list);
    assert_eq!(before.shapes, 10);
    for changed in 0..10 {
        let mut list = list.clone();
        list[changed] = [0.8, 0.1, 0.2, 1.3];
        assert_ne!(with(&list).fits.constants, before.fits.constants, "{changed}");
    }
}

/// A shape of a list that is flat or inverted is named with its det F; it is not made smaller. One that is only compressed is used as it is.
#[test]
fn flat_and_inverted_shapes_of_a_list_are_named() {
    let mut list: Vec<[f64; 4]> = (0..10).map(|i| [1.1 + 0.01 * i as f64, 0.05, -0.02, 0.95]).collect();
    let at = |list: &[[f64; 4]], perturbation: f64| {
        let sampling = Sampling { perturbation, ..listed(list) };
        fitted("tri3", &SampledFit { sampling, data: true, ..SampledFit::default() })
    };
    for (wrong, det) in
        [([-1.0, 0.0, 0.0, 1.0], "-1.0000"), ([1.0, 2.0, 0.5, 1.0], "0.0000"), ([0.01, 0.0, 0.0, 0.01], "0.0001")]
    {
        list[7] = wrong;
        let error = at(&list, 0.0).unwrap_err().to_string();
        reads(
            &error,
            &format!("gradients[7]: expected a shape that is neither flat nor inverted, … found det F = {det}"),
        )
        .unwrap();
    }
    list[7] = [0.3, 0.0, 0.0, 0.3];
    for perturbation in [0.0, 0.3] {
        let found = at(&list, perturbation).unwrap();
        let least = found.errors.iter().map(|one| one.content).fold(f64::INFINITY, f64::min);
        assert!(perturbation > 0.0 || (least - 0.09).abs() < 1e-12, "{least}");
        assert!(least >= 0.045 - 1e-12 && found.reduced <= 1, "{least} {}", found.reduced);
    }
    // States of the body, of which the second turns the cell over.
    let element = loaded("tri3");
    let x = distorted(&element, &mut Random(4));
    let turned: Vec<f64> = x.iter().enumerate().map(|(i, x)| if i % 2 == 0 { -x } else { *x }).collect();
    let source = Source::States(Arc::new(vec![x.iter().map(|x| 1.2 * x).collect(), turned]));
    let sampling = Sampling { source, perturbation: 0.0, ..Sampling::default() };
    let error = fitted("tri3", &SampledFit { sampling, ..SampledFit::default() }).unwrap_err().to_string();
    reads(&error, "states[1]: expected a shape that is neither flat nor inverted, … det F = -1.0000 in the cell with the nodes [0, 1, 2]").unwrap();
}

/// Shapes of families that would turn the cell inside out are counted.
#[test]
fn shapes_with_less_deformation_are_counted() {
    let with = |stretch: f64| {
        let sampling = Sampling { stretch: [-stretch, stretch], ..Sampling::default() };
        fitted("tri3", &SampledFit { sampling, data: true, ..SampledFit::default() }).unwrap()
    };
    assert_eq!(with(0.2).reduced, 0);
    let found = with(0.9);
    assert!(found.reduced > 10 && found.reduced < found.shapes, "{}", found.reduced);
    assert!(found.errors.iter().all(|one| one.content >= 0.2));
}

/// What a sampler cannot do is said with its key; in a list of sets with the number of the set.
#[test]
fn wrong_samplers_are_refused() {
    let families = |families: &[DeformationFamily]| of_families(families);
    let shear = families(&[DeformationFamily::SimpleShear]);
    let two = |directions: Vec<Vec<f64>>| Sampling { directions, ..shear.clone() };
    let held = |others: Sampling| Sampling { others: Some(Box::new(others)), ..shear.clone() };
    for (name, sampling, words) in [
        (
            "tri3",
            families(&[DeformationFamily::Torsion]),
            "families: expected families that cells of 2 dimensions have, found \"torsion\"",
        ),
        ("bar2", shear.clone(), "families: … 1 dimensions have, found \"simple-shear\""),
        (
            "tri3",
            two(vec![vec![1.0, 0.0], vec![1.0, 0.0, 0.0]]),
            "directions[1]: expected 2 numbers, or 4 for two axes, found 3",
        ),
        ("tri3", two(vec![vec![0.0, 0.0]]), "directions[0]: expected a direction, found …"),
        ("tri3", two(vec![vec![1.0, 0.0, -2.0, 0.0]]), "directions[0]: expected two directions that differ, found one"),
        (
            "tri3",
            Sampling { directions: vec![vec![1.0, 0.0]], ..families(&[DeformationFamily::Volumetric]) },
            "directions: expected a family with axes, found volumetric",
        ),
        ("tri3", held(families(&[])), "held_out.families: expected at least one family, found none"),
        ("tri3", held(Sampling { stretch: [0.0, 3.0], ..shear.clone() }), "held_out.stretch: … found 0 to 3"),
        ("tri3", Sampling { weight: 0.0, ..shear.clone() }, "weight: expected a number above 0, up to 1e12, found 0"),
        (
            "tri3",
            Sampling { shapes: 1, ..listed(&[]) },
            "gradients: expected deformation gradients of 4 numbers, found 0 numbers in all",
        ),
    ] {
        let fit = |sampling, beside| SampledFit { sampling, beside, ..SampledFit::default() };
        let error = fitted(name, &fit(sampling.clone(), vec![])).unwrap_err().to_string();
        reads(&error, words).unwrap_or_else(|fault| panic!("{fault:?}: {error}"));
        if name == "tri3" {
            let error = fitted(name, &fit(shear.clone(), vec![sampling])).unwrap_err().to_string();
            reads(&error, &format!("[1].{words}")).unwrap_or_else(|fault| panic!("{fault:?}: {error}"));
        }
    }
    let none = SampledFit { sampling: Sampling { held_out: 0, ..shear }, data: true, ..SampledFit::default() };
    reads(
        &fitted("tri3", &none).unwrap_err().to_string(),
        "held_out: expected shapes whose errors are the data, found none",
    )
    .unwrap();
}
