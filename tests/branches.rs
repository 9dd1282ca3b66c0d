//! Branches that yield, and branches in explicit steps: against independent integration, and against each other.

use crate::kit::{outcome, place, refusal};
use crate::messages::reads;
use crate::shapes::Random;
use crate::shapes::bodies::grid;
use crate::shapes::relaxing::{BULK, MU, Tensor, affine, points, shear, stress};
use springfit_bodies::dynamics::{BranchForm, BranchTerm, FlowMemory, LargeMemory, Memory};
use springfit_bodies::model::MaterialPoints;
use springfit_element::element::Element;
use springfit_element::material::{Material, Relaxation, RelaxationTerm, State};
use springfit_fit::fit::ShearSprings;
use springfit_mesh::mesh::Mesh;
use springfit_studies::study::MotionEnding;

fn yields(mesh: &Mesh, share: f64, time: f64, limit: f64) -> Memory {
    let term = BranchTerm { time, yield_stress: Some(limit), shares: vec![share] };
    Memory::Flow(Box::new(FlowMemory::new(points(mesh, ShearSprings::Cells), &mesh.points, &[term]).unwrap()))
}

/// `σ J = g μ (F G Fᵀ − J^(2/3) 1)`.
fn kirchhoff(f: &Tensor, g: &Tensor, modulus: f64) -> Tensor {
    (f * g * f.transpose() - Tensor::identity() * f.determinant().powf(2.0 / 3.0)) * modulus
}

/// `Ġ = max(0, 1 − σ_y/q) (H − G)/τ` with `H = J^(2/3) C⁻¹` and `q = √(3/2) |dev σ|`.
fn slope(f: &Tensor, g: &Tensor, modulus: f64, time: f64, limit: f64) -> Tensor {
    let j = f.determinant();
    let s = kirchhoff(f, g, modulus) / j;
    let q = 1.5f64.sqrt() * (s - Tensor::identity() * (s.trace() / 3.0)).norm();
    let rate = if q > limit { (1.0 - limit / q) / time } else { 0.0 };
    let h = (f.transpose() * f).try_inverse().unwrap() * j.powf(2.0 / 3.0);
    (h - g) * rate
}

/// G at the end by the method of Runge and Kutta, of the fourth order, which sees nothing of the steps of the program.
fn integrated(f: &dyn Fn(f64) -> Tensor, end: f64, steps: usize, modulus: f64, time: f64, limit: f64) -> Tensor {
    let h = end / steps as f64;
    let mut g = Tensor::identity();
    for step in 0..steps {
        let t = step as f64 * h;
        let at = |t: f64, g: &Tensor| slope(&f(t), g, modulus, time, limit);
        let k1 = at(t, &g);
        let k2 = at(t + h / 2.0, &(g + k1 * (h / 2.0)));
        let k3 = at(t + h / 2.0, &(g + k2 * (h / 2.0)));
        let k4 = at(t + h, &(g + k3 * h));
        g += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    g
}

fn follow(memory: &mut Memory, mesh: &Mesh, f: &dyn Fn(f64) -> Tensor, end: f64, steps: usize) {
    assert!(memory.reset(&affine(mesh, &f(0.0))));
    for step in 1..=steps {
        memory.prepare(end / steps as f64);
        memory.advance(&affine(mesh, &f(end * step as f64 / steps as f64)));
    }
}

/// Steps of the independent integration: of the fourth order, they leave nothing that the steps of the program could be mistaken by.
const REFERENCE: usize = 20_000;

/// The errors of a pulled and of a sheared branch that yields, over μ, against the independent integration from the start of a cycle to `end`, by the
/// steps in τ.
pub fn yield_errors<const N: usize>(end: f64, steps: [usize; N]) -> [[f64; 2]; N] {
    let pulse = |t: f64| if t < 1.0 { t } else { (2.0 - t).max(0.4) };
    let stretch = |t: f64| {
        let l = 1.0 + 0.5 * pulse(t);
        Tensor::from_diagonal(&[l, l.powf(-0.3), l.powf(-0.4)].into())
    };
    let sheared = |t: f64| shear(2.0 * pulse(t));
    let (share, time, limit) = (0.8, 0.25, 600.0);
    let mesh = grid("hex8", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let cases: [&dyn Fn(f64) -> Tensor; 2] = [&stretch, &sheared];
    let expected =
        cases.map(|f| kirchhoff(&f(end), &integrated(f, end, REFERENCE, share * MU, time, limit), share * MU));
    steps.map(|steps| {
        [0, 1].map(|case| {
            let f = cases[case];
            let mut memory = yields(&mesh, share, time, limit);
            follow(&mut memory, &mesh, f, end, (end / time).round() as usize * steps);
            (stress(&mut memory, &mesh, &f(end), 1e-6) - expected[case]).norm() / MU
        })
    })
}

/// Uniaxial stretch and simple shear at a constant rate, held, and back again, far beyond the yield stress: the stress is that of an independent
/// integration, to 1e-6 of the modulus, and its error is of the second order.
#[test]
fn a_branch_that_yields_is_its_differential_equation() {
    for (end, steps) in [(1.0, [31, 125, 500]), (2.5, [12, 50, 200])] {
        let errors = yield_errors(end, steps);
        println!("to {end}: {errors:?}");
        for case in [0, 1] {
            let [first, second, third] = errors.map(|of| of[case]);
            assert!(third < 1e-6, "to {end}: {errors:?}");
            assert!(second < first / 8.0 && third < second / 8.0, "to {end}: {errors:?}");
        }
    }
}

/// A branch that is held relaxes to its yield stress, `q = σ_y + (q₀ − σ_y) e^(−t/τ)`, at any step: the stress keeps its direction.
#[test]
fn a_branch_that_is_held_keeps_its_yield_stress() {
    let f = shear(0.7);
    let mesh = grid("tet4", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let (share, time, limit) = (0.8, 0.25, 600.0);
    let mises = |s: Tensor| 1.5f64.sqrt() * (s - Tensor::identity() * (s.trace() / 3.0)).norm();
    for steps in [1, 3, 40] {
        for end in [0.1, 1.0, 30.0] {
            let mut memory = yields(&mesh, share, time, limit);
            follow(&mut memory, &mesh, &|_| f, end, steps);
            let first = mises(kirchhoff(&f, &Tensor::identity(), share * MU));
            let expected = limit + (first - limit) * f64::exp(-end / time);
            let found = mises(stress(&mut memory, &mesh, &f, 1e-6));
            assert!((found / expected - 1.0).abs() < 1e-12, "{steps} to {end}: {found} {expected}");
        }
    }
}

/// A yield stress that is never reached leaves an elastic branch, one of nothing leaves a Maxwell branch; regions that are alike are one body.
#[test]
fn yield_stresses_have_their_limits() {
    let mesh = grid("hex8", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let of = |mut memory: Memory| {
        follow(&mut memory, &mesh, &shear, 1.0, 50);
        (stress(&mut memory, &mesh, &shear(1.0), 1e-6), memory.dissipated())
    };
    let (elastic, none) = of(yields(&mesh, 0.6, 0.3, 1e9));
    assert!((elastic - kirchhoff(&shear(1.0), &Tensor::identity(), 0.6 * MU)).norm() < 1e-12 * MU && none == 0.0);
    let series = |yield_stress| vec![RelaxationTerm { shear: 0.6, bulk: 0.0, time: 0.3, yield_stress }];
    let maxwell = Relaxation::new(series(None)).unwrap();
    let large = LargeMemory::new(points(&mesh, ShearSprings::Cells), BranchForm::Tensors, &mesh.points, &maxwell);
    let (whole, lost) = of(Memory::Large(Box::new(large.unwrap())));
    let (slight, slight_lost) = of(yields(&mesh, 0.6, 0.3, 1e-6));
    // The rules of both are of the second order, with other errors.
    assert!((whole - slight).norm() < 1e-3 * MU && (slight_lost / lost - 1.0).abs() < 1e-3, "{whole} {slight}");
    let terms = BranchTerm::of(&[Some(maxwell.clone()), None, Some(maxwell)]);
    assert_eq!(terms, [BranchTerm { time: 0.3, yield_stress: None, shares: vec![0.6, 0.0, 0.6] }]);
    let flow = FlowMemory::new(points(&mesh, ShearSprings::Cells), &mesh.points, &terms).unwrap();
    let (alike, alike_lost) = of(Memory::Flow(Box::new(flow)));
    assert!((whole - alike).norm() < 1e-12 * MU && (alike_lost / lost - 1.0).abs() < 1e-10);
}

/// 33 333 random steps of random length, with a term that yields beside one that does not: what is dissipated never decreases, no branch has less
/// energy than none, and the forces are the gradient of the potential of a step.
#[test]
fn what_flow_dissipates_is_never_negative() {
    let mesh = grid("tet4", &[0.01, 0.01, 0.01], &[1, 1, 1]);
    let terms = [
        BranchTerm { time: 0.1, yield_stress: Some(300.0), shares: vec![0.6] },
        BranchTerm { time: 3.0, yield_stress: None, shares: vec![0.3] },
    ];
    let memory = FlowMemory::new(points(&mesh, ShearSprings::Edges), &mesh.points, &terms).unwrap();
    let mut memory = Memory::Flow(Box::new(memory));
    let mut random = Random(56);
    let mut last = 0.0;
    for step in 0..33_333 {
        let swell = 1.0 + 0.3 * random.next();
        let u: Vec<f64> = mesh.points.iter().map(|x| (swell - 1.0) * x + 0.0012 * random.next()).collect();
        memory.prepare(10f64.powf(2.0 * random.next() - 1.0));
        let mut force = vec![0.0; u.len()];
        let Some(potential) = memory.add(&u, &mut force, None) else {
            memory.prepare(0.0);
            continue;
        };
        if step % 1000 == 0 {
            let (dof, by) = (7, 1e-8);
            let mut moved = u.clone();
            moved[dof] += by;
            let ahead = memory.add(&moved, &mut vec![0.0; u.len()], None).unwrap();
            let found = (ahead - potential) / by;
            let largest = force.iter().fold(1e-6f64, |largest, f| largest.max(f.abs()));
            assert!((found - force[dof]).abs() < 1e-4 * largest, "{found} {}", force[dof]);
        }
        memory.advance(&u);
        let now = memory.dissipated();
        assert!(now >= last && memory.stored(&u).unwrap() >= 0.0, "step {step}: {last} to {now}");
        last = now;
    }
    assert!(last > 0.0);
}

/// Explicit steps, which take several points at a time and keep one state for each, have the forces, the energies and the dissipation of the general
/// memory, for cells of every kind and for domains of edges, with regions or without.
#[test]
fn explicit_steps_are_the_same_steps() {
    let bodies: [(&str, &[usize], &[f64], ShearSprings); 8] = [
        ("tet4", &[3, 2, 2], &[0.03, 0.02, 0.02], ShearSprings::Cells),
        ("tet4", &[3, 2, 2], &[0.03, 0.02, 0.02], ShearSprings::Edges),
        ("hex8", &[3, 2, 2], &[0.03, 0.02, 0.02], ShearSprings::Cells),
        ("tet10", &[1, 1, 2], &[0.01, 0.01, 0.02], ShearSprings::Cells),
        ("tri3", &[4, 3], &[0.04, 0.03], ShearSprings::Cells),
        ("tri3", &[4, 3], &[0.04, 0.03], ShearSprings::Edges),
        ("quad4", &[4, 3], &[0.04, 0.03], ShearSprings::Cells),
        ("quad8", &[2, 1], &[0.02, 0.01], ShearSprings::Cells),
    ];
    let of = |shear: f64, time: f64| RelaxationTerm { shear, bulk: 0.0, time, yield_stress: None };
    let series = Relaxation::new(vec![of(0.5, 0.3), of(0.2, 2.0)]).unwrap();
    for (element, cells, size, shear) in bodies {
        let mesh = grid(element, size, cells);
        let large = LargeMemory::new(points(&mesh, shear), BranchForm::Tensors, &mesh.points, &series).unwrap();
        let mut general = Memory::Large(Box::new(large));
        let flow =
            FlowMemory::new(points(&mesh, shear), &mesh.points, &BranchTerm::of(&[Some(series.clone())])).unwrap();
        let step = 0.07;
        let mut quick = [general.clone().for_explicit(step), Memory::Flow(Box::new(flow)).for_explicit(step)];
        let mut random = Random(8);
        let mut shape = || -> Vec<f64> { mesh.points.iter().map(|x| 0.2 * x + 0.0003 * random.next()).collect() };
        let first = shape();
        assert!(general.reset(&first) && quick.iter_mut().all(|memory| memory.reset(&first)));
        for at in 0..6 {
            let u = if at == 0 { first.clone() } else { shape() };
            let h = if at == 0 { 0.0 } else { step };
            let pull = |memory: &mut Memory| {
                memory.prepare(h);
                let mut force = vec![0.0; u.len()];
                assert!(memory.pull(&u, &mut force));
                if at > 0 {
                    memory.advance(&u);
                }
                force.extend([memory.stored(&u).unwrap(), memory.dissipated()]);
                // The present forces do not change when a step ends.
                let mut again = vec![0.0; u.len()];
                assert!(memory.pull(&u, &mut again));
                let largest = again.iter().fold(0.0f64, |a, f| a.max(f.abs()));
                assert!(again.iter().zip(&force).all(|(a, b)| (a - b).abs() < 1e-12 * largest), "{element}");
                force
            };
            let expected = pull(&mut general);
            let (forces, energies) = expected.split_at(u.len());
            let size = [forces, energies].map(|list| list.iter().fold(0.0f64, |a, f| a.max(f.abs())));
            for memory in &mut quick {
                let found = pull(memory);
                for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
                    let size = if i < u.len() { size[0] } else { size[1] };
                    assert!((a - b).abs() <= 1e-12 * size, "{element} {shear:?} {at} {i}: {a} {b}");
                }
            }
        }
    }
    // A shape that is turned inside out has no forces, and the present ones stay.
    let mesh = grid("tet4", &[0.01; 3], &[1, 1, 1]);
    let large = LargeMemory::new(points(&mesh, ShearSprings::Cells), BranchForm::Edges, &mesh.points, &series).unwrap();
    let mut quick = Memory::Large(Box::new(large)).for_explicit(0.1);
    assert!(quick.reset(&vec![0.0; mesh.points.len()]));
    quick.prepare(0.1);
    let inside_out: Vec<f64> =
        mesh.points.iter().enumerate().map(|(i, x)| if i % 3 == 0 { -2.0 * x } else { 0.0 }).collect();
    assert!(!quick.pull(&inside_out, &mut vec![0.0; inside_out.len()]));
    quick.prepare(0.0);
    assert!(quick.pull(&vec![0.0; inside_out.len()], &mut vec![0.0; inside_out.len()]));
}

/// A bar that is pulled beyond its yield stress and let go.
fn bar(relaxation: &str, motion: &str) -> String {
    format!(
        r#"
[mesh]
box = {{ element = "tet4", size = [0.04, 0.02, 0.02], cells = [2, 1, 1] }}
[material]
young = 10e3
poisson = 0.3
law = "stable-neo-hookean"
relaxation = {{ terms = [{relaxation}] }}
[[fit]]
objective = "exact"
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
watch = {{ group = "xmax" }}
{motion}
"#
    )
}

/// The stretches of a bar of the stable neo-Hookean law with `(1 − g) μ` and the branch G (axial and across), under the axial force per area at rest.
/// First Piola stresses: `P = μ̄ F − μ̄ J F⁻ᵀ + (κ + μ̄/3) (J − 1) J F⁻ᵀ + g μ (F G − J^(2/3) F⁻ᵀ)`, by Newton's method with differences.
fn bar_at(pull: f64, g: [f64; 2], share: f64, start: [f64; 2]) -> [f64; 2] {
    let mu = (1.0 - share) * MU;
    let piola = |[a, b]: [f64; 2]| -> [f64; 2] {
        let j = a * b * b;
        let content = -mu + (BULK + mu / 3.0) * (j - 1.0);
        let branch = share * MU;
        let of = |l: f64, g: f64| mu * l + content * j / l + branch * (l * g - j.powf(2.0 / 3.0) / l);
        [of(a, g[0]) - pull, of(b, g[1])]
    };
    let mut x = start;
    for _ in 0..50 {
        let r = piola(x);
        let h = 1e-7;
        let columns = [0, 1].map(|k| {
            let (mut ahead, mut behind) = (x, x);
            ahead[k] += h;
            behind[k] -= h;
            let (ahead, behind) = (piola(ahead), piola(behind));
            [0, 1].map(|i| (ahead[i] - behind[i]) / (2.0 * h))
        });
        let det = columns[0][0] * columns[1][1] - columns[1][0] * columns[0][1];
        x[0] -= (r[0] * columns[1][1] - columns[1][0] * r[1]) / det;
        x[1] -= (columns[0][0] * r[1] - r[0] * columns[0][1]) / det;
    }
    x
}

/// A bar that is pulled and let go against an integration of one cell that sees nothing of the program: the elongation under the load to 1e-6 of the
/// length, and what remains at the end; the network is the finite element.
#[test]
fn a_bar_keeps_what_has_flown() {
    let (share, time, limit) = (0.7, 0.2, 400.0);
    let pull = |t: f64| 900.0 * (if t < 1.0 { t } else { 2.0 - t }).clamp(0.0, 1.0);
    let end = 2.4;
    let steps = 24_000;
    let h = end / steps as f64;
    let (mut g, mut x) = ([1.0; 2], [1.0; 2]);
    let mut elongations = vec![0.0];
    let rate = |x: [f64; 2], g: [f64; 2]| {
        let j = x[0] * x[1] * x[1];
        // q of a deviator with two equal entries.
        let q = share * MU * (x[0] * x[0] * g[0] - x[1] * x[1] * g[1]).abs() / j;
        let r = if q > limit { (1.0 - limit / q) / time } else { 0.0 };
        [0, 1].map(|i| r * (j.powf(2.0 / 3.0) / (x[i] * x[i]) - g[i]))
    };
    for step in 0..steps {
        // The method of the midpoint.
        let t = step as f64 * h;
        let k = rate(x, g);
        let half = [0, 1].map(|i| g[i] + h / 2.0 * k[i]);
        let middle = bar_at(pull(t + h / 2.0), half, share, x);
        let k = rate(middle, half);
        g = [0, 1].map(|i| g[i] + h * k[i]);
        x = bar_at(pull(t + h), g, share, middle);
        if (step + 1) % (steps / 12) == 0 {
            elongations.push(0.04 * (x[0] - 1.0));
        }
    }
    let motion = "duration = 2.4\nstep = 0.001\nevery = 0.2\n[[motion.force]]\ngroup = \"xmax\"\nforce = [\"0.18*(1 - abs(t - 1) + abs(1 - abs(t - 1)))\", 0, 0]\n";
    let term = "{ shear = 0.7, time = 0.2, yield = \"400 Pa\" }";
    let moved = outcome(&bar(term, motion)).motion.unwrap();
    for model in &moved.models {
        assert_eq!(model.ending, MotionEnding::Complete, "{}", model.name);
        let mut largest = 0.0f64;
        for (record, expected) in model.records.iter().zip(&elongations) {
            largest = largest.max((record.watched[0] - expected).abs() / 0.04);
        }
        let kept = elongations[12] / 0.04;
        println!("{}: kept {kept:.4}, error {largest:.2e}", model.name);
        assert!(largest < 1e-6 && kept > 0.01, "{}: {largest:e} {kept}", model.name);
        let lost: Vec<f64> = model.records.iter().map(|record| record.account.balance.unwrap().dissipated).collect();
        assert!(lost.windows(2).all(|pair| pair[1] >= pair[0]), "{lost:?}");
        let drift = model.records[12].account.balance.unwrap().drift;
        assert!(drift.abs() < 1e-3, "{drift}");
    }
    assert!(moved.models[1].error().unwrap()[1] < 1e-6);
}

#[test]
fn wrong_yield_stresses_are_named() {
    let motion = "duration = 1\nstep = 0.5\n[[motion.force]]\ngroup = \"xmax\"\nforce = [0.02, 0, 0]\n";
    let good = bar("{ shear = 0.6, time = 2, yield = 100 }", motion);
    for (text, message) in [
        (good.replace("yield = 100", "yield = 0"), "…material.relaxation.terms[0].yield: … found 0…"),
        (good.replace("yield = 100", "yield = -5"), "…material.relaxation.terms[0].yield: … found -5…"),
        (good.replace("yield = 100", "yield = \"5 kg\""), "…yield…5 kg…"),
        (good.replace("shear = 0.6", "bulk = 0.6"), "…material.relaxation.terms[0].yield: … none of shear…"),
        (good.replace("shear = 0.6", "shear = 0.6, bulk = 0.1"), "…material.relaxation.terms[0].yield: … of bulk too…"),
        (
            good.replace("law = \"stable-neo-hookean\"", "")
                .replace("quasi-static = true", "quasi-static = true\nlinear = true"),
            "…material.relaxation.terms[0].yield: … a law…",
        ),
    ] {
        reads(&refusal(&text), message).unwrap();
    }
}

/// A rule with a weight below zero would make energy in a branch.
#[test]
fn elements_with_negative_weights_do_not_relax() {
    let text = std::fs::read_to_string(place("elements/quad4.toml")).unwrap();
    let head = text.split("[quadrature]").next().unwrap();
    let rest = text.split("[quadrature]").nth(1).unwrap();
    let rest = &rest[rest.find("[[springs]]").unwrap()..];
    let rule = "[quadrature]\nrule = \"explicit\"\npoints = [[0, 0], [\"1/2\", \"1/2\"], [\"-1/2\", \"1/2\"], [\"1/2\", \"-1/2\"], [\"-1/2\", \"-1/2\"]]\n\
                weights = [\"-4/3\", \"4/3\", \"4/3\", \"4/3\", \"4/3\"]\n";
    let element = Element::parse(&format!("{head}{rule}{rest}")).unwrap();
    let mut mesh = grid("quad4", &[0.02, 0.01], &[2, 1]);
    mesh.blocks[0].element = element.into();
    let material = Material::new(1e4, 0.3, State::PlaneStrain { thickness: 0.5 }).unwrap();
    let found = MaterialPoints::of(&mesh, &material.into(), ShearSprings::Cells).unwrap_err().to_string();
    reads(&found, "mesh: …positive weights…found a weight below zero").unwrap();
}

/// Two regions, of which one relaxes: held for long, the body ends as the elastic one whose region has what is left of μ beside the whole bulk modulus; the
/// network is the finite element, also in explicit steps.
#[test]
fn regions_relax_unlike() {
    let scene = |first: &str, second: &str, motion: &str| {
        format!(
            r#"
[mesh]
box = {{ element = "tet4", size = [0.02, 0.01, 0.01], cells = [4, 1, 1] }}
[[material]]
where = "x < 0.01"
density = 1000
law = "stable-neo-hookean"
{first}
[[material]]
density = 1000
law = "stable-neo-hookean"
{second}
[[fit]]
objective = "exact"
[[fix]]
group = "xmin"
[motion]
{motion}
[[motion.pull]]
group = "xmax"
displacement = ["0.004*t/(t + 0.001)", "0.002*t/(t + 0.001)", 0]
"#
        )
    };
    let moduli = |mu: f64| {
        let (young, poisson) = (9.0 * BULK * mu / (3.0 * BULK + mu), (3.0 * BULK - 2.0 * mu) / (6.0 * BULK + 2.0 * mu));
        format!("young = {young:?}\npoisson = {poisson:?}\n")
    };
    let relaxing =
        |shear: f64, time: f64| format!("relaxation = {{ terms = [{{ shear = {shear:?}, time = {time:?} }}] }}\n");
    let still = "quasi-static = true\nduration = 4\nstep = 0.02\nevery = 4";
    let whole = moduli(MU);
    let first = outcome(&scene(&(whole.clone() + &relaxing(0.6, 0.1)), &whole, still));
    let both = outcome(&scene(&(whole.clone() + &relaxing(0.6, 0.1)), &(whole.clone() + &relaxing(0.3, 0.2)), still));
    let of_first = outcome(&scene(&moduli(0.4 * MU), &whole, still));
    let of_both = outcome(&scene(&moduli(0.4 * MU), &moduli(0.7 * MU), still));
    for (relaxed, elastic) in [(&first, &of_first), (&both, &of_both)] {
        let [relaxed, elastic] = [relaxed, elastic].map(|outcome| &outcome.motion.as_ref().unwrap().models);
        for (a, b) in relaxed.iter().zip(elastic) {
            let (a, b) = (&a.records[1].account, &b.records[1].account);
            assert!((a.elastic / b.elastic - 1.0).abs() < 1e-6, "{a:?} {b:?}");
            assert!(a.balance.unwrap().dissipated > 0.0);
        }
    }
    for motion in ["step = 2e-5\nintegrator = \"symplectic-euler\"", "step = 1e-3"] {
        let motion = format!("duration = 0.02\nevery = 0.01\n{motion}");
        let both =
            outcome(&scene(&(whole.clone() + &relaxing(0.6, 0.01)), &(whole.clone() + &relaxing(0.3, 0.02)), &motion));
        let models = &both.motion.as_ref().unwrap().models;
        assert!(models[1].error().unwrap()[1] < 1e-8, "{:?}", models[1].error());
    }
    let wrong = scene(&whole, &(whole.clone() + &relaxing(1.0, 0.1)), still);
    reads(&refusal(&wrong), "…material[1].relaxation.terms: … less than 1 …").unwrap();
}
