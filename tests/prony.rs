//! Springs that forget: creep, relaxation and large shear against closed forms, objectivity, dissipation, and every wrong key.

use crate::kit::{outcome, refusal};
use crate::messages::reads;
use crate::shapes::Random;
use crate::shapes::bodies::grid;
use crate::shapes::relaxing::{BULK, MU, Tensor, affine, material, points, shear, stress};
use crate::shapes::statics::support_at;
use nalgebra::{Rotation3, Vector3};
use springfit_bodies::dynamics::{
    BranchForm, Decay, Integrator, LargeMemory, LinearMemory, Memory, Motion, Options, RelaxingPart, Simulation,
};
use springfit_bodies::model::{exact_network, finite_elements, lumped_masses};
use springfit_element::material::{Moduli, Relaxation, RelaxationTerm};
use springfit_fit::fit::{ExactFit, ModulusTest, ShearSprings};
use springfit_mesh::mesh::Mesh;
use springfit_studies::study::{Event, ModelMotion, MotionEnding, Outcome, Record, Scene, run};
use std::f64::consts::TAU;
use std::path::Path;

fn series(terms: &[[f64; 3]]) -> Relaxation {
    Relaxation::new(
        terms.iter().map(|&[shear, bulk, time]| RelaxationTerm { shear, bulk, time, yield_stress: None }).collect(),
    )
    .unwrap()
}

fn branches(mesh: &Mesh, form: BranchForm, terms: &[[f64; 3]]) -> Memory {
    Memory::Large(Box::new(
        LargeMemory::new(points(mesh, ShearSprings::Cells), form, &mesh.points, &series(terms)).unwrap(),
    ))
}

/// Follows affine motions, `[steps]`, and returns the stress at the end.
fn follow(memory: &mut Memory, mesh: &Mesh, h: f64, steps: usize, f: impl Fn(f64) -> Tensor, volume: f64) -> Tensor {
    for step in 1..=steps {
        memory.prepare(h);
        memory.advance(&affine(mesh, &f(step as f64 * h)));
    }
    stress(memory, mesh, &f(steps as f64 * h), volume)
}

/// Simple shear of a body to 600 % during 2 τ: the errors of σ_xy and of N₁ against the upper-convected Maxwell model, from rest:
/// `σ_xy = μ γ̇ τ (1 − e^(−t/τ))`, `N₁ = 2 μ (γ̇ τ)² (1 − e^(−t/τ)(1 + t/τ))`, `N₂ = 0` (Bird, Armstrong, Hassager, Dynamics of Polymeric
/// Liquids 1, 1987).
fn errors_of(mesh: &Mesh, form: BranchForm, steps: usize) -> [f64; 2] {
    let (rate, end) = (3.0, 2.0);
    let exact = MU * rate * -f64::exp_m1(-end);
    let exact_n1 = 2.0 * MU * rate * rate * (1.0 - f64::exp(-end) * (1.0 + end));
    let mut memory = branches(mesh, form, &[[1.0, 0.0, 1.0]]);
    let s = follow(&mut memory, mesh, end / steps as f64, steps, |t| shear(rate * t), 2e-6);
    let (n1, n2) = (s[(0, 0)] - s[(1, 1)], s[(1, 1)] - s[(2, 2)]);
    assert!(n2.abs() < 1e-12 * n1, "{form:?}: N2 {:e}", n2 / n1);
    [(s[(0, 1)] / exact - 1.0).abs(), (n1 / exact_n1 - 1.0).abs()]
}

/// The errors of a network of tetrahedra.
pub fn shear_errors(steps: usize) -> [f64; 2] {
    errors_of(&grid("tet4", &[0.02, 0.01, 0.01], &[2, 1, 1]), BranchForm::Edges, steps)
}

/// The shear of H is linear in time, so that the rule has σ_xy to rounding; the error of N₁ falls with the square of the step.
#[test]
fn shear_to_600_percent_is_upper_convected() {
    for (element, cells) in [("tet4", [2, 1, 1]), ("hex8", [2, 1, 1]), ("tet10", [1, 1, 1]), ("hex20", [1, 1, 1])] {
        let mesh = grid(element, &[0.02, 0.01, 0.01], &cells);
        for form in [BranchForm::Edges, BranchForm::Tensors] {
            let errors = [100, 400, 1000].map(|steps| errors_of(&mesh, form, steps));
            println!("{element} {form:?}: {errors:?}");
            assert!(errors.iter().all(|error| error[0] < 1e-12), "{element} {form:?}: {errors:?}");
            assert!(errors[2][1] < 1e-6, "{element} {form:?}: {errors:?}");
            let order = (errors[0][1] / errors[1][1]).log(4.0);
            assert!((order - 2.0).abs() < 0.02, "{element} {form:?}: order {order}");
        }
    }
}

/// A body that is turned while it is deformed has the stress that is turned with it.
#[test]
fn stress_turns_with_the_body() {
    let turn = |t: f64| -> Tensor {
        let (a, b) = (1.3 * t, 0.4 + 2.1 * t);
        (Rotation3::from_axis_angle(&Vector3::z_axis(), a) * Rotation3::from_axis_angle(&Vector3::x_axis(), b))
            .into_inner()
    };
    let shape = |t: f64| Tensor::new(1.0 + 0.8 * t, 2.0 * t, 0.1, 0.0, 1.0 - 0.2 * t, 0.3 * t, 0.0, 0.1 * t, 1.0);
    let mesh = grid("hex8", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    for form in [BranchForm::Edges, BranchForm::Tensors] {
        let still = follow(&mut branches(&mesh, form, &[[0.7, 0.0, 0.5]]), &mesh, 0.05, 30, shape, 1e-6);
        let mut memory = branches(&mesh, form, &[[0.7, 0.0, 0.5]]);
        let turned = follow(&mut memory, &mesh, 0.05, 30, |t| turn(t) * shape(t), 1e-6);
        let q = turn(1.5);
        let apart = (turned - q * still * q.transpose()).amax();
        assert!(apart < 1e-12 * MU, "{form:?}: {:e}", apart / MU);
    }
}

/// A dilation has no stress of the branch at any time: `H = J^(2/3) C⁻¹ = 1`.
#[test]
fn a_dilation_does_not_relax() {
    let dilation = |t: f64| Tensor::identity() * (1.0 + 0.3 * t);
    let mesh = grid("tet4", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    for form in [BranchForm::Edges, BranchForm::Tensors] {
        let s = follow(&mut branches(&mesh, form, &[[0.9, 0.0, 0.2]]), &mesh, 0.05, 20, dilation, 1e-6);
        assert!(s.iter().all(|s| s.abs() < 1e-9 * MU), "{form:?}: {s:?}");
    }
}

/// At small strain the branch is Prony relaxation of shear alone: `2 μ g e^(−t/τ) dev ε`. The difference is of the second order in strain.
#[test]
fn a_small_strain_relaxes_in_shear_alone() {
    let size = 1e-6;
    let strain = Tensor::new(2.0, 0.7, -0.4, 0.7, -1.0, 0.5, -0.4, 0.5, 0.5);
    let f = |_: f64| strain * size + Tensor::identity();
    let mesh = grid("hex8", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let mut memory = branches(&mesh, BranchForm::Edges, &[[0.6, 0.0, 0.5], [0.3, 0.0, 2.0]]);
    assert!(memory.reset(&affine(&mesh, &f(0.0))));
    let s = follow(&mut memory, &mesh, 0.1, 7, f, 1e-6);
    let left = 0.6 * f64::exp(-0.7 / 0.5) + 0.3 * f64::exp(-0.7 / 2.0);
    let expected = (strain - Tensor::identity() * (strain.trace() / 3.0)) * (2.0 * MU * left);
    // Strains are rounded at 1e-16/1e-6.
    assert!((s / size - expected).iter().all(|apart| apart.abs() < 2e-5 * MU), "{} {expected}", s / size);
}

/// Forces are the gradient of the potential of the step, and the entries of the tangent are those of the forces, by central differences; springs
/// and tensors are one body.
#[test]
fn a_step_has_a_potential() {
    let bodies: [(&str, &[usize], &[f64]); 7] = [
        ("tet4", &[1, 1, 1], &[0.01, 0.01, 0.01]),
        ("hex8", &[1, 1, 1], &[0.01, 0.01, 0.01]),
        ("tet10", &[1, 1, 1], &[0.01, 0.01, 0.01]),
        ("tri3", &[2, 1], &[0.02, 0.01]),
        ("quad4", &[2, 1], &[0.02, 0.01]),
        ("tri6", &[1, 1], &[0.01, 0.01]),
        ("quad8", &[1, 1], &[0.01, 0.01]),
    ];
    for (element, cells, size) in bodies {
        let mesh = grid(element, size, cells);
        let mut random = Random(7);
        let mut shape = |large: f64| -> Vec<f64> { mesh.points.iter().map(|_| large * 0.01 * random.next()).collect() };
        let (first, second, u) = (shape(0.05), shape(0.08), shape(0.1));
        let mut answers: Vec<(Vec<f64>, f64)> = Vec::new();
        for form in [BranchForm::Edges, BranchForm::Tensors] {
            let mut memory = branches(&mesh, form, &[[0.5, 0.0, 0.3], [0.2, 0.0, 2.0]]);
            for u in [&first, &second] {
                memory.prepare(0.2);
                memory.advance(u);
            }
            memory.prepare(0.15);
            let places = memory.places();
            let (mut force, mut tangent) = (vec![0.0; u.len()], vec![0.0; places.len()]);
            let potential = memory.add(&u, &mut force, Some(&mut tangent)).unwrap();
            let largest = force.iter().fold(0.0f64, |a, f| a.max(f.abs()));
            let step = 1e-7;
            for dof in 0..u.len() {
                let mut moved = u.clone();
                let mut at = |by: f64| {
                    moved[dof] = u[dof] + by;
                    let mut force = vec![0.0; u.len()];
                    (memory.add(&moved, &mut force, None).unwrap(), force)
                };
                let ((ahead, of_ahead), (behind, of_behind)) = (at(step), at(-step));
                let slope = (ahead - behind) / (2.0 * step);
                assert!((slope - force[dof]).abs() < 1e-6 * largest, "{element} {form:?}: {slope} {}", force[dof]);
                let mut column = vec![0.0; u.len()];
                for (&(row, other), k) in places.iter().zip(&tangent) {
                    if other == dof {
                        column[row] += k;
                    } else if row == dof {
                        column[other] += k;
                    }
                }
                for (row, k) in column.iter().enumerate() {
                    let found = (of_ahead[row] - of_behind[row]) / (2.0 * step);
                    assert!((found - k).abs() < 1e-5 * largest / 0.001, "{element} {form:?} {row} {dof}: {found} {k}");
                }
            }
            memory.advance(&u);
            answers.push((force, potential));
            answers.push((vec![memory.stored(&u).unwrap(), memory.dissipated()], 0.0));
        }
        let (springs, tensors) = answers.split_at(2);
        for (a, b) in springs.iter().zip(tensors) {
            let size = b.0.iter().fold(b.1.abs(), |a, f| a.max(f.abs()));
            let apart = a.0.iter().zip(&b.0).fold((a.1 - b.1).abs(), |apart, (a, b)| apart.max((a - b).abs()));
            assert!(apart < 1e-11 * size, "{element}: {:e}", apart / size);
        }
    }
}

/// 10⁵ random steps of random length: what is dissipated never decreases, and no branch has less energy than none.
#[test]
fn dissipation_is_never_negative() {
    let mesh = grid("tet4", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let dofs = mesh.points.len();
    let stiffness = |lambda: f64, mu: f64| finite_elements(&mesh, Moduli { lambda, mu });
    let part = |entries, shares| RelaxingPart::new(&entries, dofs, shares).unwrap();
    let linear = || {
        let shear = part(stiffness(-2.0 / 3.0 * MU, MU), vec![0.6, 0.3]);
        let bulk = part(stiffness(BULK, 0.0), vec![0.2, 0.0]);
        Memory::Linear(LinearMemory::new(vec![0.1, 3.0], vec![shear, bulk], dofs).unwrap())
    };
    let terms = [[0.6, 0.0, 0.1], [0.3, 0.0, 3.0]];
    for mut memory in
        [linear(), branches(&mesh, BranchForm::Edges, &terms), branches(&mesh, BranchForm::Tensors, &terms)]
    {
        let mut random = Random(55);
        let mut last = 0.0;
        let is_linear = memory.is_linear();
        for step in 0..33_334 {
            // Volumes change by −70 % to 100 %: this is where energies with a logarithm fail.
            let swell = 1.0 + 0.3 * random.next();
            let u: Vec<f64> = mesh.points.iter().map(|x| (swell - 1.0) * x + 0.0012 * random.next()).collect();
            let h = 10f64.powf(2.0 * random.next() - 1.0);
            memory.prepare(h);
            let mut force = vec![0.0; dofs];
            if memory.add(&u, &mut force, None).is_none() {
                memory.prepare(0.0);
                continue;
            }
            memory.advance(&u);
            let now = memory.dissipated();
            assert!(now >= last, "step {step}: {last} to {now}");
            assert!(is_linear || memory.stored(&u).unwrap() >= 0.0, "step {step}");
            last = now;
        }
        assert!(last > 0.0);
    }
}

/// The weights of a step against sums of exponentials by adaptive halving (Simpson's rule on 2 000 pieces).
#[test]
fn what_a_maxwell_element_dissipates_is_its_integral() {
    for x in [1e-6, 1e-3, 0.1, 0.7, 0.999, 1.001, 3.0, 20.0] {
        let decay = Decay::new(x, 1.0);
        let (a, c) = (0.8, -1.3);
        let stretch = |y: f64| a * f64::exp(-y) - c * f64::exp_m1(-y) / x;
        let n = 2000;
        let weight = |i: usize| if i == 0 || i == n { 1.0 } else { [2.0, 4.0][i % 2] };
        let sum: f64 = (0..=n).map(|i| weight(i) * stretch(x * i as f64 / n as f64).powi(2)).sum();
        let [own, both, other] = decay.dissipation();
        let found = own * a * a + both * a * c + other * c * c;
        let expected = sum * x / (3.0 * n as f64);
        assert!((found / expected - 1.0).abs() < 1e-8, "{x}: {found} {expected}");
    }
}

/// A bar of 96 tetrahedra under uniaxial stress, and how it is driven.
fn bar(terms: &str, fits: &str, motion: &str) -> String {
    format!(
        r#"
[mesh]
box = {{ element = "tet4", size = [0.04, 0.02, 0.02], cells = [4, 2, 2] }}
[material]
young = 10e3
poisson = 0.3
relaxation = {{ terms = [{terms}] }}
{fits}
[[fix]]
where = "x < 1e-9"
axes = ["x"]
[[fix]]
where = "y < 1e-9"
axes = ["y"]
[[fix]]
where = "z < 1e-9"
axes = ["z"]
[motion]
quasi-static = true
linear = true
watch = {{ group = "xmax" }}
{motion}
"#
    )
}

const EXACT: &str = "[[fit]]\nobjective = \"exact\"\n[[fit]]\nname = \"smooth\"\nobjective = \"exact\"\nshear = \"edges\"\nvolume = \"patches\"\n";

/// 0.02 N at once, for 5 s.
const CREEPING: &str =
    "duration = 5\nstep = 0.02\nevery = 0.5\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n";

/// The largest error of the elongation of a bar that creeps under 0.02 N with the shares g and k and τ = 2 s.
fn error_of_creep(model: &ModelMotion, [g, k]: [f64; 2]) -> f64 {
    let creep = |g: f64, t: f64| 1.0 - g / (1.0 - g) * f64::exp_m1(-(1.0 - g) * t / 2.0);
    let error = |record: &Record| {
        let (t, stress) = (record.account.time, 0.02 / 4e-4);
        let strain = stress * (creep(g, t) / (3.0 * MU) + creep(k, t) / (9.0 * BULK));
        (record.watched[0] / (0.04 * strain) - 1.0).abs()
    };
    model.records.iter().map(error).fold(0.0, f64::max)
}

/// The error of the finite elements with `shear = 0.6` during 2.5 τ, with this step over τ.
pub fn creep_error(step: f64) -> f64 {
    let motion = format!(
        "duration = 5\nstep = {:?}\nevery = 0.5\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n",
        2.0 * step
    );
    let outcome = outcome(&bar("{ shear = 0.6, time = 2 }", "[[fit]]\nobjective = \"exact\"\n", &motion));
    error_of_creep(&outcome.motion.unwrap().models[0], [0.6, 0.0])
}

/// The errors of creep at a hundredth of τ of the finite elements, of the exact network and of the smoothed one, with these shares.
pub fn creep_errors([g, k]: [f64; 2]) -> Vec<f64> {
    let outcome = outcome(&bar(&format!("{{ shear = {g:?}, bulk = {k:?}, time = 2 }}"), EXACT, CREEPING));
    outcome.motion.unwrap().models.iter().map(|model| error_of_creep(model, [g, k])).collect()
}

/// Creep under a force that acts at once: `ε = σ (J_G/3 + J_K/9)`, with the compliances
/// `J(t) = (1 + g/(1 − g) (1 − e^(−(1 − g) t/τ)))/modulus` of a modulus of which the share g relaxes with τ: the standard linear solid.
#[test]
fn a_bar_creeps_as_prony() {
    for (terms, g, k) in [
        ("{ shear = 0.6, bulk = 0.6, time = \"2 s\" }", 0.6, 0.6),
        ("{ shear = 0.6, time = \"2 s\" }", 0.6, 0.0),
        ("{ bulk = 0.6, time = 2 }", 0.0, 0.6),
        ("{ shear = 0.6, time = 2 }, { bulk = 0.3, time = 2 }", 0.6, 0.3),
    ] {
        let outcome = outcome(&bar(terms, EXACT, CREEPING));
        let motion = outcome.motion.as_ref().unwrap();
        assert_eq!(motion.models.len(), 3);
        for model in &motion.models {
            assert_eq!((model.steps, &model.ending), (250, &MotionEnding::Complete), "{}", model.name);
            let largest = error_of_creep(model, [g, k]);
            for record in &model.records {
                let balance = record.account.balance.unwrap();
                assert!(balance.drift.abs() < 1e-4 && record.account.kinetic == 0.0, "{balance:?}");
            }
            println!("creep, {terms}, {}: {largest:.2e}", model.name);
            assert!(largest < 1e-6, "{} {terms}: {largest:e}", model.name);
            assert_grows(model);
        }
    }
}

/// Steps that are divided by the estimate of their error follow a bar that creeps much faster than they are; what is allowed bounds the error,
/// whose part in the shear modulus that is left, 0.4, is amplified by 0.6/0.4.
#[test]
fn steps_are_divided_by_their_error() {
    let pull = |keys: &str| {
        format!("{keys}duration = 5\nstep = 1\nevery = 1\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n")
    };
    let error = |keys: &str| {
        let outcome = outcome(&bar("{ shear = 0.6, time = 2 }", EXACT, &pull(keys)));
        let models = outcome.motion.unwrap().models;
        for model in &models {
            assert_eq!((model.steps, &model.ending), (5, &MotionEnding::Complete));
            assert_grows(model);
        }
        error_of_creep(&models[1], [0.6, 0.0])
    };
    let [whole, coarse, fine] = ["", "error = 1e-3\n", "error = 1e-6\n"].map(error);
    println!("errors of divided steps: {whole:e} {coarse:e} {fine:e}");
    assert!(coarse < 1.5e-3 && fine < 1.5e-6 && fine > 1e-8 && whole > coarse, "{whole:e} {coarse:e} {fine:e}");
}

/// What has been dissipated never decreases from record to record.
fn assert_grows(model: &ModelMotion) {
    let lost: Vec<f64> = model.records.iter().map(|record| record.account.balance.unwrap().dissipated).collect();
    assert!(lost.windows(2).all(|pair| pair[1] >= pair[0]) && lost[0] == 0.0, "{}: {lost:?}", model.name);
    assert!(lost[lost.len() - 1] > 0.0, "{}", model.name);
}

/// A bar that cannot move across and is held at a strain at once has the energy `½ ε² V Σ M_i e^(−2t/τ_i)` of its Maxwell elements, with
/// the moduli `M = K + 4 μ/3`; what is missing has been dissipated. This holds at any step.
#[test]
fn a_bar_that_is_held_relaxes_as_prony() {
    let across = "[[fix]]\nwhere = \"x > -1\"\naxes = [\"y\", \"z\"]\n";
    let pull = "duration = 6\nstep = 1.5\nevery = 1.5\n[[motion.pull]]\ngroup = \"xmax\"\ndisplacement = [4e-4, \"free\", \"free\"]\n";
    for (terms, parts) in [
        (
            "{ shear = 0.5, bulk = 0.5, time = 1 }, { shear = 0.2, bulk = 0.2, time = 4 }",
            [[0.5, 0.5, 1.0], [0.2, 0.2, 4.0]],
        ),
        ("{ shear = 0.5, time = 1 }, { shear = 0.2, bulk = 0.1, time = 4 }", [[0.5, 0.0, 1.0], [0.2, 0.1, 4.0]]),
    ] {
        let outcome = outcome(&(bar(terms, EXACT, pull) + across));
        for model in &outcome.motion.as_ref().unwrap().models {
            let whole = BULK + 4.0 / 3.0 * MU;
            let energy = |t: f64| {
                let of = |[g, k, tau]: [f64; 3]| (k * BULK + g * 4.0 / 3.0 * MU) * f64::exp_m1(-2.0 * t / tau);
                0.5 * 1e-4 * 1.6e-5 * (whole + parts.into_iter().map(of).sum::<f64>())
            };
            for record in &model.records {
                let account = &record.account;
                let (found, expected) = (account.elastic, energy(account.time));
                assert!(
                    (found / expected - 1.0).abs() < 1e-10,
                    "{} at {}: {found} {expected}",
                    model.name,
                    account.time
                );
                let lost = account.balance.unwrap().dissipated;
                assert!((lost - (energy(0.0) - expected)).abs() < 1e-10 * energy(0.0), "{}: {lost}", model.name);
            }
        }
    }
}

/// Classical fits relax by linearity; one that is not linear in the moduli is refused, unless shear and bulk relax alike.
#[test]
fn classical_fits_relax_by_linearity() {
    let pull = "duration = 4\nstep = 0.05\nevery = 1\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n";
    let fit = "[[fit]]\nobjective = \"modal\"\nsprings = [\"edge\", \"bulk\"]\n";
    let of = |terms: &str, fit: &str| outcome(&bar(terms, fit, pull));
    let alike = of("{ shear = 0.6, bulk = 0.6, time = 2 }", fit);
    let model = &alike.motion.as_ref().unwrap().models[1];
    let (first, last) = (&model.records[0], &model.records[4]);
    let creep = 1.0 - 1.5 * f64::exp_m1(-0.4 * 4.0 / 2.0);
    assert!((last.watched[0] / first.watched[0] / creep - 1.0).abs() < 2e-5, "{:?}", last.watched);
    let apart = of("{ shear = 0.6, time = 2 }", fit);
    let model = &apart.motion.as_ref().unwrap().models[1];
    assert_grows(model);
    assert!(model.records[4].watched[0] < last.watched[0]);
    // Its constants are multiples of Young's modulus, which is no sum of shear and bulk.
    let message = refusal(&bar("{ shear = 0.6, time = 2 }", "[[fit]]\nobjective = \"van-gelder\"\n", pull));
    reads(&message, "…material.relaxation.terms: …not linear in the moduli…").unwrap();
}

/// A column of three regions of 10 mm that cannot move across and is pulled by 0.02 N, quasi-static, with the keys of each region.
fn layers(keys: [&str; 3], fits: &str, motion: &str) -> String {
    let places = ["where = \"x < 0.01\"", "where = \"x > 0.01 && x < 0.02\"", ""];
    let regions = places.into_iter().zip(keys).map(|(place, keys)| format!("[[material]]\n{place}\n{keys}\n"));
    let regions: String = regions.collect();
    format!(
        r#"
[mesh]
box = {{ element = "tet4", size = [0.03, 0.02, 0.02], cells = [6, 2, 2] }}
{regions}
{fits}
[[fix]]
group = "xmin"
[[fix]]
where = "x > -1"
axes = ["y", "z"]
[motion]
quasi-static = true
linear = true
watch = {{ group = "xmax" }}
{motion}
[[motion.force]]
group = "xmax"
force = [0.02, 0, 0]
"#
    )
}

/// Regions that relax unlike, or not at all: under one stress the strain of each is that of its standard linear solid, `M = K + 4 μ/3` with the share
/// `g 4 μ/(3 M)` where shear relaxes alone. Finite elements and the exact network follow the sum; fits whose stress is not even end where
/// the networks of the relaxed moduli are.
#[test]
fn layers_relax_unlike() {
    let with = |relaxation: &str| format!("young = 10e3\npoisson = 0.3\n{relaxation}");
    let relaxing = |terms: &str| with(&format!("relaxation = {{ terms = [{terms}] }}"));
    let keys = [relaxing("{ shear = 0.6, time = 2 }"), relaxing("{ shear = 0.3, bulk = 0.3, time = 0.5 }"), with("")];
    let modulus = BULK + 4.0 / 3.0 * MU;
    let creep = |g: f64, tau: f64, t: f64| 1.0 - g / (1.0 - g) * f64::exp_m1(-(1.0 - g) * t / tau);
    let expected = |t: f64| {
        let share = 0.6 * 4.0 / 3.0 * MU / modulus;
        0.01 * (0.02 / 4e-4) / modulus * (creep(share, 2.0, t) + creep(0.3, 0.5, t) + 1.0)
    };
    let keys = keys.each_ref().map(String::as_str);
    let moved = outcome(&layers(keys, EXACT, "duration = 3\nstep = 0.005\nevery = 0.5\n"));
    for model in &moved.motion.as_ref().unwrap().models[..2] {
        for record in &model.records {
            let (found, expected) = (record.watched[0], expected(record.account.time));
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{} {}: {found} {expected}",
                model.name,
                record.account.time
            );
            assert!(record.account.balance.unwrap().drift.abs() < 1e-4);
        }
        assert_grows(model);
    }

    let fits = EXACT.to_string() + "[[fit]]\nobjective = \"modal\"\nsprings = [\"edge\", \"bulk\"]\n";
    let long = "duration = 80\nstep = 0.5\nevery = 80\n";
    let relaxed = outcome(&layers(keys, &fits, long)).motion.unwrap();
    let moduli = |shear: f64, bulk: f64| {
        let (mu, k) = (shear * MU, bulk * BULK);
        format!(
            "young = {:?}\npoisson = {:?}",
            9.0 * k * mu / (3.0 * k + mu),
            (3.0 * k - 2.0 * mu) / (6.0 * k + 2.0 * mu)
        )
    };
    let left = [moduli(0.4, 1.0), moduli(0.7, 0.7), moduli(1.0, 1.0)];
    let elastic = outcome(&layers(left.each_ref().map(String::as_str), &fits, long)).motion.unwrap();
    assert_eq!(relaxed.models.len(), 4);
    for (relaxed, elastic) in relaxed.models.iter().zip(&elastic.models) {
        let [a, b] = [relaxed, elastic].map(|model| model.records.last().unwrap().watched[0]);
        assert!((a / b - 1.0).abs() < 1e-9, "{}: {a} {b}", relaxed.name);
    }

    let published = "[[fit]]\nobjective = \"van-gelder\"\n";
    reads(&refusal(&layers(keys, published, long)), "…relaxation.terms: …not linear in the moduli…").unwrap();
    let whole = "[[fit]]\nobjective = \"whole\"\n";
    let alike = [relaxing("{ shear = 0.3, bulk = 0.3, time = 0.5 }"), with(""), with("")];
    let found = refusal(&layers(alike.each_ref().map(String::as_str), whole, long));
    reads(&found, "…relaxation.terms: expected one series of the whole body…").unwrap();
}

/// A column of the stable neo-Hookean law that is bent and pulled far.
fn column(element: &str, motion: &str, fit: &str) -> String {
    format!(
        r#"
[mesh]
box = {{ element = "{element}", size = [0.01, 0.01, 0.03], cells = [1, 1, 3] }}
[material]
young = 10e3
poisson = 0.3
density = 1000
law = "stable-neo-hookean"
relaxation = {{ terms = [{{ shear = 0.5, time = "20 ms" }}, {{ shear = 0.2, time = "0.2 s" }}] }}
[[fit]]
objective = "exact"
{fit}
[[fix]]
group = "zmin"
[motion]
{motion}
watch = {{ group = "zmax" }}
[[motion.pull]]
group = "zmax"
displacement = ["0.02*(1 - cos(12*t))", 0, "0.004*sin(15*t)"]
"#
    )
}

/// The network is the finite element, with every method of time; the balance of energy closes as the step goes to zero.
#[test]
fn exact_networks_move_as_finite_elements() {
    for element in ["tet4", "hex8"] {
        for integrator in ["implicit-euler", "bdf2", "newmark", "symplectic-euler"] {
            let step = if integrator == "symplectic-euler" { 2e-4 } else { 2e-3 };
            let motion = format!("integrator = \"{integrator}\"\nduration = 0.2\nstep = {step:?}\nevery = 0.02");
            let outcome = outcome(&column(element, &motion, ""));
            let models = &outcome.motion.as_ref().unwrap().models;
            for model in models {
                assert_eq!(model.ending, MotionEnding::Complete, "{element} {integrator} {}", model.name);
                assert_grows(model);
            }
            let error = models[1].error().unwrap()[1];
            println!("{element} {integrator}: {error:.2e} %, {:?}", models[1].records[10].account.balance);
            assert!(error < 1e-6, "{element} {integrator}: {error} %");
        }
    }
    // The trapezoidal sums and Newmark's method are of the second order.
    let drift = |step: f64| {
        let motion = format!("integrator = \"newmark\"\nduration = 0.1\nstep = {step:?}\nevery = 0.1");
        let outcome = outcome(&column("hex8", &motion, ""));
        outcome.motion.as_ref().unwrap().models[1].records[1].account.balance.unwrap().drift.abs()
    };
    let [coarse, fine] = [4e-3, 5e-4].map(drift);
    println!("drift {coarse:e} {fine:e}");
    assert!(fine < coarse / 16.0 && fine < 1e-3, "{coarse} {fine}");
}

/// Without inertia a body that was bent and is held ends in the equilibrium of what is left; smooth networks too.
#[test]
fn a_body_that_is_held_ends_with_what_is_left() {
    let motion = "quasi-static = true\nduration = 4\nstep = 0.05\nevery = 1";
    let held = |text: String| text.replace("0.02*(1 - cos(12*t))", "0.006").replace("0.004*sin(15*t)", "0.002");
    for fit in ["", "shear = \"edges\"\n"] {
        let relaxed = outcome(&held(column("tet4", motion, fit)));
        // μ falls to 0.3 of itself beside the whole K.
        let (mu, k) = (0.3 * MU, BULK);
        let (young, poisson) = (9.0 * k * mu / (3.0 * k + mu), (3.0 * k - 2.0 * mu) / (6.0 * k + 2.0 * mu));
        let plain = held(column("tet4", motion, fit)).replace("young = 10e3", &format!("young = {young:?}"));
        let plain = plain.replace("poisson = 0.3", &format!("poisson = {poisson:?}"));
        let plain: String =
            plain.lines().filter(|line| !line.starts_with("relaxation")).map(|l| format!("{l}\n")).collect();
        let elastic = outcome(&plain);
        for (a, b) in relaxed.motion.unwrap().models.iter().zip(&elastic.motion.unwrap().models) {
            let (last, expected) = (&a.records[4].account, &b.records[4].account);
            // e^(−4/0.2) = 2e-9 of the branch is left.
            assert!((last.elastic / expected.elastic - 1.0).abs() < 1e-7, "{}: {last:?} {expected:?}", a.name);
            assert_grows(a);
        }
    }
}

/// Symplectic Euler is stable up to the limit that the program tells, which is that of the stiffness against a sudden strain, whatever the
/// relaxation time.
#[test]
fn the_stable_step_is_that_of_a_sudden_strain() {
    let mesh = grid("hex8", &[0.01, 0.01, 0.03], &[1, 1, 3]);
    let map = material(3);
    let network = exact_network(&mesh, &map, &ExactFit::default(), &[]).unwrap();
    let masses = lumped_masses(&mesh, 1000.0, 1.0, Default::default());
    let stiffness = network.stiffness(&mesh.points);
    let support = support_at(&mesh, &mesh.groups["zmin"].points);
    for time in [1e-5, 1e-3, 3e-3, 0.1, 10.0] {
        let part = RelaxingPart::new(&stiffness, mesh.points.len(), vec![0.7]).unwrap();
        let memory = Some(Memory::Linear(LinearMemory::new(vec![time], vec![part], mesh.points.len()).unwrap()));
        let motion = Motion { support: support.clone(), memory, ..Motion::free(&network, &mesh.points, &masses) };
        let options =
            Options { step: 1e-6, integrator: Integrator::SymplecticEuler, linear: true, ..Options::default() };
        let longest = Simulation::new(motion.clone(), options).unwrap().longest_step();
        let mut simulation = Simulation::new(motion, Options { step: 0.999 * longest, ..options }).unwrap();
        let mut random = Random(3);
        let u: Vec<f64> = mesh.points.iter().map(|_| 1e-5 * random.next()).collect();
        simulation.start(&u, &vec![0.0; u.len()]).unwrap();
        let energy = |simulation: &mut Simulation| simulation.account().total();
        let first = energy(&mut simulation);
        for _ in 0..20_000 {
            simulation.step();
        }
        let last = energy(&mut simulation);
        // The energy of a motion at the limit swings by 1/(1 − (ω h/2)²); beyond the limit it grows without bound.
        assert!(last < 1e3 * first, "{time}: {first:e} to {last:e}");
    }
}

#[test]
fn wrong_keys_are_named() {
    let pull = "duration = 5\nstep = 0.5\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n";
    let with = |terms: &str| bar(terms, EXACT, pull);
    let good = with("{ shear = 0.6, time = 2 }");
    for (terms, message) in [
        ("", ": … found none"),
        ("{ shear = -0.1, time = 2 }", "[0].shear: … found -0.1"),
        ("{ bulk = 1.1, time = 2 }", "[0].bulk: … found 1.1"),
        ("{ shear = nan, time = 2 }", "[0].shear: … found NaN"),
        ("{ time = 2 }", "[0]: … found none"),
        ("{ shear = 0.6, time = 0 }", "[0].time: … found 0"),
        ("{ shear = 0.6, time = -3 }", "[0].time: … found -3"),
        ("{ shear = 0.6, time = \"2 kg\" }", "…time…2 kg"),
        ("{ shear = 0.6 }", "…time"),
        ("{ shear = 0.6, time = 1 }, { shear = 0.5, time = 2 }", ": … found 1.1"),
    ] {
        reads(&refusal(&with(terms)), &format!("…material.relaxation.terms{message}…")).unwrap();
    }
    let unlike = good.replace("relaxation = ", "# ");
    for (text, from, to, message) in [
        (&good, "linear = true\n", "", "…motion.linear: expected true …"),
        (&good, "static = true", "static = true\nintegrator = \"newmark\"", "…motion.integrator: …"),
        (&good, "static = true", "static = true\ndamping = { rayleigh = [1, 0] }", "…motion.damping: …"),
        (&good, "quasi-static = true\n", "", "…material.density: …"),
        (&good, "quasi-static = true\n", "error = 0.1\n", "…motion.error: …quasi-static = true…"),
        (&good, "static = true", "static = true\nerror = 0", "…motion.error: … found 0…"),
        (&unlike, "static = true", "static = true\nerror = 0.1", "…motion.error: … found one without…"),
        (&good, "static = true", "static = true\ngravity = [0, 0, -9.81]", "…material.density: …"),
    ] {
        reads(&refusal(&text.replace(from, to)), message).unwrap();
    }
    let large = column("hex8", "duration = 1\nstep = 0.1", "");
    for (from, to, message) in [
        ("step = 0.1", "step = 0.1\nlinear = true", "…motion.linear: expected false …"),
        ("shear = 0.2,", "shear = 0.2, bulk = 0.1,", "…material.relaxation.bulk: … found 0.1…"),
        ("shear = 0.2,", "shear = 0.5,", "…material.relaxation.terms: … less than 1 … found 1…"),
        ("stable-neo-hookean", "neo-hookean", "…material.relaxation.terms: … \"neo-hookean\"…"),
        ("\"exact\"", "\"modal\"", "…material.relaxation.terms: expected exact networks …"),
    ] {
        reads(&refusal(&large.replace(from, to)), message).unwrap();
    }
    let plane = good.replace("tet4", "tri3").replace("0.02, 0.02], cells = [4, 2, 2]", "0.02], cells = [4, 2]");
    let plane =
        plane.replace("[[fix]]\nwhere = \"z < 1e-9\"\naxes = [\"z\"]\n", "").replace("[0.02, 0, 0]", "[0.02, 0]");
    reads(&refusal(&plane), "…material.relaxation.terms: … found plane stress…").unwrap();
    let mut notes = Vec::new();
    let long = Scene::parse(&good.replace("time = 2", "time = 0.01"), Path::new("scene.toml")).unwrap();
    let mut hear = |event: Event| {
        if let Event::Note(note) = event {
            notes.push(note.to_string());
        }
    };
    run(&long, &mut hear).unwrap();
    assert!(notes.iter().any(|note| note.contains("50.000 times the shortest relaxation time")), "{notes:?}");
}

/// A table that a Prony series with times of the fit has made gives that series; other times give its moduli; tables that no series has are named.
#[test]
fn measured_moduli_give_their_series() {
    let times: Vec<f64> = (0..41).map(|i| 0.01 * 10f64.powf(i as f64 / 10.0)).collect();
    // The times of the fit are two in each decade from 0.01 to 100 s.
    let known = [[0.3, 0.1], [0.2, 10.0]];
    let modulus =
        |t: f64, terms: &[[f64; 2]]| 8e3 * terms.iter().fold(1.0, |sum, [g, tau]| sum + g * f64::exp_m1(-t / tau));
    let moduli: Vec<f64> = times.iter().map(|t| modulus(*t, &known)).collect();
    let fitted = ModulusTest::Relaxation { times: &times, moduli: &moduli }.fit().unwrap();
    assert!(fitted.error < 1e-9 && (fitted.modulus / 8e3 - 1.0).abs() < 1e-6, "{fitted:?}");
    let large: Vec<&[f64; 2]> = fitted.terms.iter().filter(|[share, _]| *share > 1e-5).collect();
    assert_eq!(large.len(), 2, "{fitted:?}");
    for (found, expected) in large.iter().zip(known) {
        assert!((found[0] - expected[0]).abs() < 1e-5 && (found[1] / expected[1] - 1.0).abs() < 1e-9, "{fitted:?}");
    }
    // Other times: the series is another, its moduli are near.
    let others = [[0.4, 0.4], [0.15, 3.0]];
    let frequencies: Vec<f64> = (0..31).map(|i| 0.03 * 10f64.powf(i as f64 / 10.0)).collect();
    let sum = |of: &dyn Fn(f64) -> f64| others.iter().map(|[g, tau]| g * of(*tau)).sum::<f64>();
    let storage = |f: &f64| 8e3 * (1.0 - sum(&|tau| 1.0 / (1.0 + (TAU * f * tau).powi(2))));
    let loss = |f: &f64| 8e3 * sum(&|tau| TAU * f * tau / (1.0 + (TAU * f * tau).powi(2)));
    let (storage, loss): (Vec<f64>, Vec<f64>) = frequencies.iter().map(|f| (storage(f), loss(f))).unzip();
    let test = ModulusTest::Frequencies { frequencies: &frequencies, storage: &storage, loss: &loss };
    let fitted = test.fit().unwrap();
    println!("{fitted:?}");
    assert!(fitted.error < 0.01 && (fitted.modulus / 8e3 - 1.0).abs() < 0.02, "{fitted:?}");
    series(&fitted.terms.iter().map(|[share, time]| [*share, 0.0, *time]).collect::<Vec<_>>());
    let wrong =
        |times: &[f64], moduli: &[f64]| ModulusTest::Relaxation { times, moduli }.fit().unwrap_err().to_string();
    for (message, pattern) in [
        (wrong(&[1.0, 2.0], &[2.0, 1.0]), "time: … found 2"),
        (wrong(&[1.0, 2.0, 2.0], &[2.0, 1.0, 0.5]), "time: … found 2 after 2"),
        (wrong(&[0.0, 2.0, 3.0], &[2.0, 1.0, 0.5]), "time: … found 0.0"),
        (wrong(&[1.0, 2.0, 3.0], &[2.0, 1.0]), "modulus: … found 2"),
        (wrong(&[1.0, 2.0, 3.0], &[2.0, 1.0, -0.5]), "modulus: … found -0.5"),
        (wrong(&[1.0, 2.0, 3.0], &[2.0, 1.0, 1.5]), "modulus: … fall with time, found 1.5 after 1"),
    ] {
        reads(&message, pattern).unwrap();
    }
}

/// A creep test of a series gives that series: the compliance is integrated from `∫ G(t − s) dJ(s) = 1`, of which the fit knows nothing.
#[test]
fn measured_compliances_give_their_series() {
    // The creep of one term is known: J = (1 − g e^(−t/λ))/(G_0 (1 − g)) with λ = τ/(1 − g). λ is one of the times of the fit.
    let times: Vec<f64> = (0..41).map(|i| 0.01 * 10f64.powf(i as f64 / 10.0)).collect();
    let (share, delay, modulus) = (0.4, 1.0, 8e3);
    let creep = |t: &f64| (1.0 - share * f64::exp(-t / delay)) / (modulus * (1.0 - share));
    let compliances: Vec<f64> = times.iter().map(creep).collect();
    let fitted = ModulusTest::Creep { times: &times, compliances: &compliances }.fit().unwrap();
    assert!(fitted.error < 1e-9 && (fitted.modulus / modulus - 1.0).abs() < 1e-6, "{fitted:?}");
    let large: Vec<&[f64; 2]> = fitted.terms.iter().filter(|[share, _]| *share > 1e-5).collect();
    assert!(large.len() == 1 && (large[0][0] - share).abs() < 1e-5, "{fitted:?}");
    assert!((large[0][1] / (delay * (1.0 - share)) - 1.0).abs() < 1e-5, "{fitted:?}");
    // Several terms at any times: steps of the integral by the trapezoidal rule, which errs with their square.
    let known = [[0.3, 0.05], [0.25, 0.7], [0.2, 6.0]];
    let relaxed = |t: f64| known.iter().fold(1.0, |sum, [g, tau]| sum + g * f64::exp_m1(-t / tau));
    let (step, count) = (2e-3, 4000);
    let mut creep = vec![1.0 / relaxed(0.0)];
    for n in 1..=count {
        let mean = |m: usize| (relaxed(step * (n - m) as f64) + relaxed(step * (n - m + 1) as f64)) / 2.0;
        let before: f64 = (1..n).map(|m| mean(m) * (creep[m] - creep[m - 1])).sum();
        creep.push(creep[n - 1] + (1.0 - relaxed(step * n as f64) * creep[0] - before) / mean(n));
    }
    let places: Vec<usize> = (0..25).map(|i| (10f64.powf(i as f64 / 24.0 * (count as f64).log10())) as usize).collect();
    let mut places: Vec<usize> = places.into_iter().filter(|n| *n > 0).collect();
    places.dedup();
    let times: Vec<f64> = places.iter().map(|n| step * *n as f64).collect();
    let compliances: Vec<f64> = places.iter().map(|n| creep[*n] / modulus).collect();
    let fitted = ModulusTest::Creep { times: &times, compliances: &compliances }.fit().unwrap();
    assert!(fitted.error < 0.01, "{fitted:?}");
    for t in &times {
        let found = fitted.modulus * fitted.terms.iter().fold(1.0, |sum, [g, tau]| sum + g * f64::exp_m1(-t / tau));
        assert!((found / (modulus * relaxed(*t)) - 1.0).abs() < 0.03, "{t}: {found} {}", modulus * relaxed(*t));
    }
    let wrong = |compliances: &[f64]| {
        ModulusTest::Creep { times: &[1.0, 2.0, 3.0], compliances }.fit().unwrap_err().to_string()
    };
    for (message, pattern) in [
        (wrong(&[1.0, 2.0]), "compliance: … found 2"),
        (wrong(&[1.0, 2.0, 1.5]), "compliance: … rise with time, found 1.5 after 2"),
        (wrong(&[-1.0, 2.0, 3.0]), "compliance: … 1/Pa above zero… found -1.0"),
        (wrong(&[1.0, 2.0, 3.0]), "compliance: … at once…"),
    ] {
        reads(&message, pattern).unwrap();
    }
}

/// A scene that has measured moduli moves as one that has their series; its note has the error.
#[test]
fn a_scene_takes_measured_moduli() {
    let times = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0];
    // τ = 1 s is one of the times of the fit, 10^(−1 + i/2) for 0.1 to 10 s.
    let moduli: Vec<f64> = times[..5].iter().map(|t| 2e3 * (1.0 + 0.4 * f64::exp_m1(-t))).collect();
    let motion = "duration = 2\nstep = 0.1\nevery = 1\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n";
    let given = bar("{ shear = 0.4, time = 1 }", EXACT, motion);
    let list = format!("relaxation = {{ measured = {{ time = {:?}, modulus = {moduli:?} }} }}", &times[..5]);
    let measured = given.replace("relaxation = { terms = [{ shear = 0.4, time = 1 }] }", &list);
    let [given, fitted] = [given, measured.clone()].map(|text| outcome(&text));
    let end = |outcome: &Outcome| outcome.motion.as_ref().unwrap().models[1].records[2].watched[0];
    assert!((end(&fitted) / end(&given) - 1.0).abs() < 1e-6, "{} {}", end(&fitted), end(&given));
    let note = fitted.of_loads.iter().find(|note| note.contains("Prony series")).unwrap();
    assert!(note.contains("an error of 0.00 %") && note.contains("2.0000e3 Pa"), "{note}");
    for (text, message) in [
        (
            measured.replace("measured = {", "terms = [{ shear = 0.1, time = 1 }], measured = {"),
            "…relaxation.measured: … found both…",
        ),
        (measured.replace("time = [0.1", "time = [-0.1"), "…relaxation.measured.time: … found -0.1…"),
        (measured.replace("modulus = [", "storage = ["), "…relaxation.measured: … \"loss\", found others…"),
        (measured.replace("modulus = [", "of = \"bulk\", modulus = ["), "…relaxation.measured.of: …bulk…"),
    ] {
        reads(&refusal(&text), message).unwrap();
    }
}
