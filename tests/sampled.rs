//! The sampled fit: its limit for small shapes, its optimality, what it does for a body pulled by a third of its length.

use crate::kit::{outcome, outcome_in};
use crate::messages::reads;
use crate::shapes::bodies::grid;
use crate::shapes::statics::support_at;

use crate::shapes::{Random, distorted, geometry, loaded};
use nalgebra::{DMatrix, DVector};
use springfit_bodies::model::{Action, Body, Elastic, Network, nodal_forces};
use springfit_bodies::solve::{Ending, Newton};
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material, Plane, State};
use springfit_element::springs::{Force, Law, Springs};
use springfit_fit::fit::{
    Balance, CellFits, DeformationFamily, Fit, Higher, Norm, Objective, SampledFit, SampledFits, Sampling, Source,
    Weight, Weights, fit_cells, fit_sampled,
};
use springfit_mesh::mesh::{BoxMesh, Selection};
use springfit_studies::study::{Scene, displacement_error};
use std::sync::Arc;

fn every(element: &Element) -> Vec<String> {
    element.springs.iter().map(|g| g.name.clone()).collect()
}

/// The fit of one element with nodes at `x`, E = 1, ν = 0.3.
pub fn sampled(element: &Arc<Element>, springs: &Springs, x: &[f64], law: &str, fit: &SampledFit) -> SampledFits {
    let material = Material::for_body(element.dimension(), 1.0, 0.3, None, None).unwrap();
    let energy = Energy::load(law, material).unwrap();
    let cells: Vec<usize> = (0..element.nodes()).collect();
    fit_sampled(element, springs, x, &cells, &energy, material.state(), fit, &mut |_| {}).unwrap()
}

pub fn law(text: &str, springs: &Springs) -> Force {
    Force::of_all(Law::parse(text).unwrap(), springs.names().len())
}

const BASIC: [DeformationFamily; 4] = [
    DeformationFamily::Uniaxial,
    DeformationFamily::Equibiaxial,
    DeformationFamily::SimpleShear,
    DeformationFamily::Volumetric,
];
/// A cubic whose slope is not below zero at strains up to a half, where its parameters are not.
const CUBIC: &str = "k1*(0.125 - (0.5 - s)^3) + k2*(0.75*s - s^3) + k3*((0.5 + s)^3 - 0.125)";

/// For shapes that shrink to rest the forces become `R u` and `g_s g_sᵀ u`, and the fit that of the tangents with the weight
/// `U = Σ u uᵀ` of the displacements sampled: `min Σ_q ‖(R − K) u_q‖²`. The difference falls with the size of the shapes. The share
/// of the forces that remains is that of the tangents, `1 − bᵀk/tr(R U R)`: springs at the lengths of a generic cell leave half.
#[test]
fn small_shapes_give_the_fit_of_the_tangent() {
    for name in ["tri3", "quad4", "tet4"] {
        let element = loaded(name);
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut Random(4));
        let d = element.dimension();
        let material = Material::for_body(d, 1.0, 0.3, None, None).unwrap();
        let geometry = geometry(&element, &x);
        let r = geometry.stiffness(material.moduli());
        let mut g = Vec::new();
        springs.gradients(&x, &geometry, &mut g);
        let at = |size: f64| {
            let stretch = [-size, size];
            let sampling =
                Sampling { shapes: 4096, held_out: 0, stretch, perturbation: size, seed: 3, ..Sampling::default() };
            let fit = SampledFit { sampling, ..SampledFit::default() };
            let found = sampled(&element, &springs, &x, "neo-hookean", &fit);
            (found.fits.constants, found.trained[0])
        };
        // The weight of evenly filled cubes: F − I and the nodes' moves, each with the variance of its size.
        let size = x.len();
        let extent = geometry.content().powf(1.0 / d as f64);
        let mut weight = DMatrix::<f64>::identity(size, size) * extent * extent;
        for k in 0..d {
            for l in 0..d {
                let u = DVector::from_fn(size, |i, _| if i % d == k { x[i / d * d + l] } else { 0.0 });
                weight += &u * u.transpose();
            }
        }
        let m = springs.len();
        let rows: Vec<DVector<f64>> = g.chunks_exact(size).map(DVector::from_column_slice).collect();
        let gram = DMatrix::from_fn(m, m, |s, t| rows[s].dot(&rows[t]) * (rows[s].transpose() * &weight * &rows[t])[0]);
        let rhs = DVector::from_fn(m, |s, _| (rows[s].transpose() * &r * &weight * &rows[s])[0]);
        let expected = gram.lu().solve(&rhs).unwrap();
        let error =
            |k: &[f64]| k.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / expected.amax();
        // What 4096 shapes leave of evenness.
        assert!(error(&at(1e-5).0) < 0.01, "{name}: {}", error(&at(1e-5).0));
        let (small, (smaller, left)) = (at(1e-3).0, at(1e-5));
        let of_tangent = (1.0 - rhs.dot(&expected) / (&r * &weight * &r).trace()).sqrt();
        println!("{name}: {:.1} % of small forces remain, of the tangents {:.1} %", 100.0 * left, 100.0 * of_tangent);
        assert!((left - of_tangent).abs() < 0.01, "{name}: {left} {of_tangent}");
        let change = small.iter().zip(&smaller).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / expected.amax();
        assert!(change < 5e-3 && change > 1e-9, "{name}: {change}");
    }
}

/// No other constants do better on the shapes of the fit; bounded ones are not below zero; a seed repeats itself.
#[test]
fn the_fit_is_the_least_of_its_sum() {
    for name in ["tri3", "quad4", "tet4", "hex8"] {
        let element = loaded(name);
        let springs = Springs::select(&element, Some(&every(&element))).unwrap();
        let x = distorted(&element, &mut Random(8));
        for energy in ["neo-hookean", "corotational", "ogden"] {
            for force in [Force::Linear, law(CUBIC, &springs)] {
                let fit = SampledFit { force, ..SampledFit::default() };
                let free = sampled(&element, &springs, &x, energy, &fit);
                let nonnegative = SampledFit { nonnegative: true, ..fit.clone() };
                let bounded = sampled(&element, &springs, &x, energy, &nonnegative);
                assert_eq!(free, sampled(&element, &springs, &x, energy, &fit));
                assert!(bounded.fits.constants.iter().chain(&bounded.fits.parameters).all(|k| *k >= 0.0));
                assert!(free.trained[0] <= bounded.trained[0] + 1e-12 && free.trained[0] < 1.0, "{name} {energy}");
                let tied = sampled(&element, &springs, &x, energy, &SampledFit { tied: true, ..fit });
                assert!(free.trained[0] <= tied.trained[0] + 1e-12, "{name} {energy}");
                // Shapes that were not seen are as well fitted as those that were, nearly.
                let ratio = free.held_out[0] / free.trained[0];
                assert!((0.7..1.5).contains(&ratio), "{name} {energy}: {ratio}");
            }
        }
    }
}

#[test]
fn samplings_out_of_range_are_told() {
    let element = loaded("tri3");
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(2, 1.0, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let x = element.positions.clone();
    let shapes = |sampling: Sampling| SampledFit { sampling, ..SampledFit::default() };
    let families =
        |list: &[DeformationFamily]| Sampling { source: Source::Families(list.to_vec()), ..Sampling::default() };
    let bounds = vec![("b".to_string(), [0.0, 1.0])];
    for (fit, error) in [
        (shapes(Sampling { shapes: 0, ..Sampling::default() }), "shapes: … found 0"),
        (shapes(Sampling { stretch: [0.0, 3.0], ..Sampling::default() }), "stretch: … -2 to 2, found 0 to 3"),
        (
            shapes(Sampling { perturbation: -1.0, ..Sampling::default() }),
            "perturbation: expected a share from 0 to 2, found -1",
        ),
        (shapes(Sampling { stretch: [0.0; 2], perturbation: 0.0, ..Sampling::default() }), "stretch: … found none"),
        (shapes(families(&[])), "families: expected at least one family, found none"),
        (shapes(families(&[DeformationFamily::Torsion])), "families: … found \"torsion\""),
        (
            shapes(Sampling { source: Source::Gradients(Arc::new(vec![1.0; 5])), ..Sampling::default() }),
            "gradients: … 4 numbers, found 5 numbers in all",
        ),
        (SampledFit { higher: 2.0, ..SampledFit::default() }, "higher: expected a scale from 0 to 1, found 2"),
        (SampledFit { bounds: bounds.clone(), ..SampledFit::default() }, "bounds: … without a law … found \"b\""),
        (SampledFit { bounds, force: law("k*s", &springs), ..SampledFit::default() }, "bounds: … law, k, found \"b\""),
        (
            SampledFit { norm: Norm::One, force: law("k*(exp(a*s) - 1)", &springs), ..SampledFit::default() },
            "norm: … found One",
        ),
    ] {
        let found = fit_sampled(&element, &springs, &x, &[0, 1, 2], &energy, material.state(), &fit, &mut |_| {});
        reads(&found.unwrap_err().to_string(), error).unwrap();
    }
}

/// A law that is linear in its parameters has the same optimum by steps within bounds that do not bind.
#[test]
fn steps_within_bounds_find_the_direct_optimum() {
    let element = loaded("hex8");
    let springs = Springs::select(&element, Some(&every(&element))).unwrap();
    let x = distorted(&element, &mut Random(5));
    let direct = SampledFit { force: law(CUBIC, &springs), nonnegative: true, ..SampledFit::default() };
    let bounds = vec![("k1".to_string(), [0.0, 1e9])];
    let stepped = sampled(&element, &springs, &x, "neo-hookean", &SampledFit { bounds, ..direct.clone() });
    let direct = sampled(&element, &springs, &x, "neo-hookean", &direct);
    assert_eq!(stepped.fits.unreached, 0);
    assert!((stepped.trained[0] - direct.trained[0]).abs() < 1e-7, "{} {}", stepped.trained[0], direct.trained[0]);
}

/// Springs that choose their rest lengths do no worse than those that keep them, have positive rest lengths, and the network
/// that they make pulls at rest as the fit says.
#[test]
fn free_rest_lengths_are_positive_and_better() {
    for name in ["tri3", "quad4", "tet4", "hex8"] {
        let element = loaded(name);
        let springs = Springs::select(&element, Some(&every(&element))).unwrap();
        let d = element.dimension();
        let size = [1.0, 0.8, 1.3][..d].to_vec();
        let mesh = BoxMesh { element: element.clone(), size, cells: vec![1; d], origin: vec![0.0; d] }.build().unwrap();
        let material = Material::for_body(d, 1.0, 0.3, None, None).unwrap();
        let energy = Energy::load("neo-hookean", material).unwrap();
        let sampling = Sampling { source: Source::Families(BASIC.to_vec()), ..Sampling::default() };
        let kept = SampledFit { sampling, nonnegative: true, ..SampledFit::default() };
        let free = SampledFit { force: Force::FreeRest, ..kept.clone() };
        let [kept, free] = [kept, free].map(|fit| {
            let cells = &mesh.blocks[0].connectivity;
            fit_sampled(&element, &springs, &mesh.points, cells, &energy, material.state(), &fit, &mut |_| {}).unwrap()
        });
        assert!(free.trained[0] <= kept.trained[0] + 1e-12, "{name}");
        let network = Network::assemble(&mesh, std::slice::from_ref(&free.fits));
        for spring in &network.lengths {
            let [a, b] = spring.points.map(|p| mesh.point(p));
            let length = springfit_element::springs::distance(a, b);
            let share = spring.rest / length;
            assert!((0.5 - 1e-12..=2.0 + 1e-12).contains(&share), "{name}: {share}");
        }
    }
}

/// In the norms that are not least squares the fit is the least as well: no other constants around do better.
#[test]
fn other_norms_are_least_in_themselves() {
    let element = loaded("tet4");
    let springs = Springs::select(&element, None).unwrap();
    let x = distorted(&element, &mut Random(8));
    let sampling = Sampling { shapes: 60, ..Sampling::default() };
    let of = |norm: Norm, shapes: usize| {
        let sampling = Sampling { shapes, ..sampling.clone() };
        sampled(&element, &springs, &x, "neo-hookean", &SampledFit { norm, sampling, ..SampledFit::default() })
    };
    let two = of(Norm::Two, 60);
    for norm in [Norm::One, Norm::Max, Norm::Huber { share: 0.5 }] {
        let found = of(norm, 60);
        assert_eq!(found.fits.unreached, 0);
        assert!(found.trained[0] >= two.trained[0], "{norm:?}");
        assert!(found.trained[0] < 2.0 * two.trained[0], "{norm:?}: {} {}", found.trained[0], two.trained[0]);
        assert_ne!(found.fits.constants, two.fits.constants);
    }
    // Huber's is least squares where no residual is large.
    let huber = of(Norm::Huber { share: 1e3 }, 60);
    assert!((huber.trained[0] - two.trained[0]).abs() < 1e-9);
}

/// Of `W = μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J` the first term is, on a simplex, the energy of springs that pull in proportion to
/// their length, `k = −μ V ∇N_i·∇N_j`, and the rest that of one volume spring, `T = (−μ + λ ln J)/J`: at any stretch.
#[test]
fn springs_are_a_neo_hookean_simplex_exactly() {
    for name in ["tri3", "tet4"] {
        let element = loaded(name);
        let springs = Springs::select(&element, Some(&every(&element))).unwrap();
        assert_eq!(springs.names(), ["edge", "bulk"]);
        let d = element.dimension();
        let plane = (d == 2).then_some(Plane::Strain);
        let material = Material::for_body(d, 1.0, 0.3, plane, None).unwrap();
        let energy = Energy::load("neo-hookean", material).unwrap();
        let laws = ["k*c", "a/(1 + s) + b*ln(1 + s)/(1 + s)"].map(|text| Arc::new(Law::parse(text).unwrap()));
        let sampling = Sampling { stretch: [-0.6, 0.6], perturbation: 0.2, ..Sampling::default() };
        let fit = SampledFit { force: Force::Laws(laws.to_vec()), sampling, ..SampledFit::default() };
        for seed in 1..6 {
            let x = distorted(&element, &mut Random(seed));
            let cells: Vec<usize> = (0..element.nodes()).collect();
            let found =
                fit_sampled(&element, &springs, &x, &cells, &energy, material.state(), &fit, &mut |_| {}).unwrap();
            assert!(found.held_out[0] < 1e-7, "{name}: {}", found.held_out[0]);
            let geometry = geometry(&element, &x);
            let (lambda, mu) = (0.3 / 1.3 / 0.4, 0.5 / 1.3);
            let gradient = |a: usize| &geometry.gradients[a * d..(a + 1) * d];
            let product = |[a, b]: [usize; 2]| gradient(a).iter().zip(gradient(b)).map(|(g, h)| g * h).sum::<f64>();
            let pairs = springs.pairs().iter().map(|&pair| -mu * geometry.content() * product(pair));
            for (k, expected) in found.fits.parameters.iter().zip(pairs.chain([-mu, lambda])) {
                assert!((k - expected).abs() < 1e-7, "{name}: {k} {expected}");
            }
        }
    }
}

/// A neo-Hookean cube pulled and sheared by a third, at loads that no fit has seen: springs fitted to forces follow it better than
/// any springs of the same groups fitted to the stiffness at rest, with rest lengths of their own, with a cubic law, and, of
/// tetrahedra, with laws that are exact.
#[test]
fn sampled_springs_follow_large_deformations() {
    const LOADS: [[f64; 3]; 3] = [[0.0, 0.0, 0.26], [0.0, 0.05, 0.0], [0.02, 0.02, 0.18]];
    for (name, cells) in [("hex8", 3), ("tet4", 3)] {
        let mesh = grid(name, &[1.0; 3], &[cells; 3]);
        let block = &mesh.blocks[0];
        let material = Material::new(1.0, 0.3, State::Solid).unwrap();
        let energy = Energy::load("neo-hookean", material).unwrap();
        let support = support_at(&mesh, &Selection::Group("zmin".into()).points(&mesh).unwrap());
        let newton = Newton { steps: 2, ..Newton::default() };
        let solve = |model: &dyn Elastic, load: &[f64; 3]| {
            let action = Action::traction(load);
            let forces = nodal_forces(&mesh, &Selection::Group("zmax".into()), &action, 1.0).unwrap();
            let found = newton.solve(model, &mesh.points, &support, &forces).unwrap();
            assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
            found.displacement
        };
        let body = LOADS.map(|load| solve(&Body::new(&mesh, &(energy.clone(), State::Solid).into()), &load));
        let stretch = body[0].iter().skip(2).step_by(3).fold(0.0f64, |a, u| a.max(*u));
        assert!((0.25..0.4).contains(&stretch), "{stretch}");
        let springs = Springs::select(&block.element, Some(&every(&block.element))).unwrap();
        // The geometric mean over the loads.
        let error = |fits: CellFits| {
            let network = Network::assemble(&mesh, &[fits]);
            let errors = LOADS.iter().zip(&body);
            let error =
                |(load, body): (&[f64; 3], &Vec<f64>)| displacement_error(body, &solve(&network, load), 3).unwrap().rms;
            errors.map(error).map(|e| e.max(1e-9).ln()).sum::<f64>().exp().powf(1.0 / 3.0)
        };
        let (points, cells) = (&mesh.points, &block.connectivity);
        let weights = [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::DEFAULT)];
        let objectives = weights.map(Objective::Frobenius).into_iter().chain([Objective::Divergence(Balance::DEFAULT)]);
        let at_rest = |objective: Objective| {
            let fit = Fit { nonnegative: true, ..Fit::new(objective) };
            error(fit_cells(&block.element, &springs, points, cells, material.moduli(), &fit, &mut |_| {}).unwrap())
        };
        let best = objectives.map(at_rest).fold(f64::INFINITY, f64::min);
        let source = Source::Families(vec![DeformationFamily::Uniaxial, DeformationFamily::SimpleShear]);
        let sampling = Sampling { source, stretch: [-0.1, 0.35], perturbation: 0.02, ..Sampling::default() };
        let sampled = |force: Force| {
            let nonnegative = matches!(&force, Force::Laws(laws) if laws[0].parameters.len() > 1);
            let fit = SampledFit {
                sampling: sampling.clone(),
                force,
                weights: Weights::Relative,
                nonnegative,
                ..SampledFit::default()
            };
            let found =
                fit_sampled(&block.element, &springs, points, cells, &energy, State::Solid, &fit, &mut |_| {}).unwrap();
            error(found.fits)
        };
        let groups = springs.names().len();
        let cubic = format!("{CUBIC} + p*(s + 1/2) + q*(s - 1)");
        let mut laws: Vec<_> = (0..groups).map(|_| Arc::new(Law::parse("k*c").unwrap())).collect();
        laws[groups - 1] = Arc::new(Law::parse("a/(1 + s) + b*ln(1 + s)/(1 + s)").unwrap());
        let [free, cubic, exact] =
            [Force::FreeRest, Force::of_all(Law::parse(&cubic).unwrap(), groups), Force::Laws(laws)].map(sampled);
        println!(
            "{name}: at rest {best:.2}, sampled: free rest {free:.2}, cubic {cubic:.2}, k c and volume {exact:.4}"
        );
        assert!(free < best && cubic < best && exact < 0.5 * best, "{name}");
        assert!(name == "hex8" || exact < 1e-4, "{exact}");
    }
}

/// What a fit cannot know it says: unknowns that no shape feels are zero and counted, laws without finite values are errors, and
/// shapes that are hardly deformed do not drown the others.
#[test]
fn fits_that_shapes_do_not_determine_are_told() {
    let element = loaded("tet4");
    let springs = Springs::select(&element, None).unwrap();
    let x = distorted(&element, &mut Random(3));
    let material = Material::new(1.0, 0.3, State::Solid).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let with = |sampling: Sampling, text: &str, nonnegative: bool| {
        let fit = SampledFit { sampling, force: law(text, &springs), nonnegative, ..SampledFit::default() };
        let fit = SampledFit { weights: Weights::Relative, ..fit };
        fit_sampled(&element, &springs, &x, &[0, 1, 2, 3], &energy, State::Solid, &fit, &mut |_| {})
    };
    let grown = Sampling {
        source: Source::Families(vec![DeformationFamily::Volumetric]),
        stretch: [0.2, 0.5],
        perturbation: 0.0,
        ..Sampling::default()
    };
    for nonnegative in [false, true] {
        let found = with(grown.clone(), "k*ramp(s) + m*ramp(-s)", nonnegative).unwrap();
        assert_eq!(found.fits.deficient, 1);
        assert!(found.fits.parameters.chunks_exact(2).all(|p| p[0].is_finite() && p[1] == 0.0));
        assert!(found.trained[0] < 0.3);
    }
    for text in ["k*ln(s - 3)", "k*s^1.5", "k*(exp(a*ln(s)) - 1)", "k*abs(s)^(1/2)"] {
        let error = with(Sampling::default(), text, false).unwrap_err().to_string();
        assert!(error.starts_with("force: ") && error.contains("finite"), "{text}: {error}");
    }
    // The identity and a quarter turn among shapes that are stretched.
    let quiet = [[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]];
    let stretched = |a: f64| [1.0 + a, 0.0, 0.1 * a, 0.0, 1.0 - 0.3 * a, 0.0, 0.0, 0.2 * a, 1.0 - 0.3 * a];
    let loud: Vec<f64> = (1..=8).flat_map(|i| stretched(0.05 * f64::from(i))).collect();
    let list = |gradients: Vec<f64>| Sampling {
        source: Source::Gradients(Arc::new(gradients)),
        perturbation: 0.0,
        held_out: 0,
        ..Sampling::default()
    };
    let without = with(list(loud.clone()), "k*s", false).unwrap().fits.constants;
    let beside = with(list([&quiet.concat()[..], &loud].concat()), "k*s", false).unwrap().fits.constants;
    let largest = without.iter().fold(0.0f64, |a, k| a.max(k.abs()));
    assert!(without.iter().zip(&beside).all(|(a, b)| (a - b).abs() < 0.2 * largest), "{without:?} {beside:?}");
    // A list too short to keep any of it apart has no others.
    let few = Sampling { held_out: 10, ..list(stretched(0.3).to_vec()) };
    assert!(with(few, "k*s", false).unwrap().held_out[0].is_nan());
    let none = SampledFit::default();
    let nothing = Springs::select(&element, Some(&[])).unwrap();
    let found = fit_sampled(&element, &nothing, &x, &[0, 1, 2, 3], &energy, State::Solid, &none, &mut |_| {});
    reads(&found.unwrap_err().to_string(), "springs: … found none").unwrap();
}

/// Of a list of 100 deformation gradients 80 are fitted and 20 held out, each once. A fit of fewer says so, one of more is refused, and
/// errors name the keys of the scene.
#[test]
fn shapes_of_a_list_that_are_left_out_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String =
        (0..100).map(|i| format!("{},0,0,{}\n", 1.0 + 0.001 * i as f64, 1.0 - 0.0005 * i as f64)).collect();
    std::fs::write(folder.path().join("list.csv"), rows).unwrap();
    let ran = |shapes: &str| {
        let text = format!(
            "[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [1, 1] }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
             plane = \"strain\"\nthickness = 1\n[[fit]]\nobjective = \"sampled\"\nlaw = \"neo-hookean\"\n[fit.shapes]\n{shapes}\n"
        );
        outcome_in(folder.path(), &text)
    };
    for (keys, is_left_out) in [("count = 79", true), ("count = 80", false), ("", false)] {
        let outcome = ran(&format!("gradients = \"list.csv\"\n{keys}")).unwrap();
        let notes = springfit_report::report::notes(&outcome);
        let says = notes.iter().any(|note| note.contains("the first 79 of the 80 shapes of the list"));
        assert_eq!(says, is_left_out, "{keys}: {notes:?}");
        let count = outcome.fits[0].kind.sampled().map(|sampled| sampled.shapes);
        assert_eq!(count, Some(if is_left_out { 79 } else { 80 }), "{keys}");
    }
    for (keys, key) in [
        ("stretch = [0.3, -0.1]", ":12: fit[0].shapes.stretch"),
        ("perturbation = 5", ":12: fit[0].shapes.perturbation"),
        ("count = 0", ":12: fit[0].shapes.count"),
        (
            "gradients = \"list.csv\"\ncount = 81",
            "fit[0].shapes.count: expected at most 80, the shapes of the list that are fitted, found 81",
        ),
        (
            "gradients = \"list.csv\"\nheld_out = 21",
            "fit[0].shapes.held_out: expected at most 20, the shapes of the list that are held out, found 21",
        ),
        ("families = [\"torsion\"]", ":12: fit[0].shapes.families"),
        ("families = []", ":12: fit[0].shapes.families"),
    ] {
        let error = ran(keys).unwrap_err().to_string();
        assert!(error.contains(key), "{keys}: {error}");
    }
}

/// A group that is named twice, or none, is no choice of springs.
#[test]
fn springs_are_named_once() {
    for (springs, found) in [("[\"edge\", \"edge\"]", "\"edge\" again"), ("[]", "none")] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        let text = format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
             [[fit]]\nobjective = \"frobenius\"\nsprings = {springs}\n"
        );
        std::fs::write(&path, text).unwrap();
        let error = Scene::load(&path).unwrap_err().to_string();
        assert!(
            error.contains(&format!("fit[0].springs: expected groups of the element, each once, found {found}")),
            "{error}"
        );
    }
}

/// One shape leaves many optima. The smallest constants of all of them are above zero, so that the bound changes nothing: 55.26 N/m in the norm.
#[test]
fn a_bound_that_the_smallest_optimum_satisfies_changes_nothing() {
    let constants = |nonnegative: bool| -> Vec<f64> {
        let outcome = outcome(&format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [0.01, 0.01, 0.01], cells = [1, 1, 1] }}\n[material]\nyoung = 10e3\npoisson = 0.2\n\
             law = \"neo-hookean\"\n[[fit]]\nobjective = \"sampled\"\nnonnegative = {nonnegative}\n\
             shapes = {{ count = 1, held_out = 5, families = [\"volumetric\"], perturbation = 0 }}\n"
        ));
        assert_eq!(outcome.fits[0].deficient, 1);
        outcome.fits[0].network.lengths.iter().map(|spring| spring.constant).collect()
    };
    let (free, bounded) = (constants(false), constants(true));
    let norm = |k: &[f64]| k.iter().map(|k| k * k).sum::<f64>().sqrt();
    assert!((norm(&free) - 55.26).abs() < 0.01 && free.iter().all(|k| *k > 0.0), "{free:?}");
    assert!(free.iter().zip(&bounded).all(|(a, b)| (a - b).abs() < 1e-6 * norm(&free)), "{free:?} {bounded:?}");
}
