//! Networks in engines that end their sweeps early, against loops that make the steps one after the other.

use crate::kit::{holding, springfit};
use crate::shapes::Random;
use crate::shapes::bodies::{grid, mapped};
use springfit_bodies::engine::{
    Ceiling, Engine, Frames, Order, Sequence, Setting, Sweep, Truncated, TruncatedModel, colours,
};
use springfit_bodies::model::{Elastic, Network, Support, masses};
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_identify::whole::{Displacements, LeastSquares, Object, Target, Unknowns};
use springfit_mesh::mesh::Mesh;

/// A bent and distorted bar of tetrahedra that is held at one end, with springs on lengths and on volumes.
struct Bar {
    mesh: Mesh,
    network: Network,
    masses: Vec<f64>,
    support: Support,
}

impl Bar {
    fn new(seed: u64) -> Bar {
        let mesh = mapped(grid("tet4", &[0.06, 0.02, 0.02], &[3, 2, 1]), |x| {
            let phase = seed as f64 + 300.0 * x[0] + 700.0 * x[1] + 1100.0 * x[2];
            let shake = [1.0, 2.0, 3.0].map(|k: f64| 6e-4 * (k * phase).sin());
            vec![x[0] + shake[0], x[1] + shake[1] + 4.0 * x[0] * x[0], x[2] + shake[2]]
        });
        let material = Material::for_body(3, 1e4, 0.35, None, None).unwrap();
        let element = &mesh.blocks[0].element;
        let groups: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        let springs = Springs::select(element, Some(&groups)).unwrap();
        let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
        let cells = &mesh.blocks[0].connectivity;
        let fits = fit_cells(element, &springs, &mesh.points, cells, material.moduli(), &fit, &mut |_| {}).unwrap();
        let network = Network::assemble(&mesh, &[fits]);
        // Fits leave some constants at zero, which no compliance has.
        let mut network = network;
        let mean = network.lengths.iter().map(|s| s.constant).sum::<f64>() / network.lengths.len() as f64;
        network.lengths.iter_mut().for_each(|s| s.constant = s.constant.max(0.05 * mean));
        network.others.retain(|s| s.constant > 0.0);
        let masses = masses(&mesh, 1000.0, 1.0);
        let mut support = Support::free(&mesh);
        let held: Vec<usize> = (0..mesh.points.len() / 3).filter(|&p| mesh.points[3 * p] < 2e-3).collect();
        support.fix(&held, &[0, 1, 2], 3);
        Bar { mesh, network, masses, support }
    }

    fn model(&self) -> TruncatedModel<'_> {
        TruncatedModel { network: &self.network, points: &self.mesh.points, masses: &self.masses }
    }

    fn force(&self, seed: u64) -> Vec<f64> {
        let mut random = Random(seed);
        let free = |dof: usize| !self.support.is_fixed(dof);
        (0..self.mesh.points.len()).map(|dof| if free(dof) { 5e-5 * random.next() } else { 0.0 }).collect()
    }

    /// The points, the gradient at rest and the constant of each spring, by formulas of lengths and volumes.
    fn rows(&self) -> Vec<(Vec<usize>, Vec<f64>, f64)> {
        let at = |p: usize| [0, 1, 2].map(|k| self.mesh.points[3 * p + k]);
        let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
        };
        let mut rows = Vec::new();
        for spring in &self.network.lengths {
            let [i, j] = spring.points;
            let along = minus(at(j), at(i));
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            let g = along.iter().map(|x| -x / length).chain(along.iter().map(|x| x / length)).collect();
            rows.push((vec![i, j], g, spring.constant));
        }
        for spring in &self.network.others {
            let p = spring.points.to_vec();
            let [u, v, w] = [1, 2, 3].map(|a| minus(at(p[a]), at(p[0])));
            let [g1, g2, g3] = [cross(v, w), cross(w, u), cross(u, v)].map(|g| g.map(|g| g / 6.0));
            let g0 = [0, 1, 2].map(|k| -g1[k] - g2[k] - g3[k]);
            rows.push((p, [g0, g1, g2, g3].concat(), spring.constant));
        }
        rows
    }
}

/// The displacements at rest of a plain loop over linear springs: predictions, sweeps, velocities; velocities are damped between substeps,
/// which does not move the rest.
fn settled(bar: &Bar, setting: &Setting, force: &[f64]) -> Vec<f64> {
    let rows = bar.rows();
    let size = force.len();
    let weight = |dof: usize| if bar.support.is_fixed(dof) { 0.0 } else { 1.0 / bar.masses[dof / 3] };
    let all: Vec<Vec<usize>> =
        rows.iter().map(|(points, ..)| points.iter().flat_map(|p| 3 * p..3 * p + 3).collect()).collect();
    let along = |row: usize, u: &[f64]| all[row].iter().zip(&rows[row].1).map(|(&dof, g)| u[dof] * g).sum::<f64>();
    let of_point: Vec<Vec<(usize, usize)>> = (0..size / 3)
        .map(|p| (0..rows.len()).filter_map(|r| Some((r, rows[r].0.iter().position(|q| *q == p)?))).collect())
        .collect();
    let h = setting.step / setting.substeps as f64;
    let order = match setting.order {
        Order::Given => (0..rows.len()).collect::<Vec<usize>>(),
        Order::Colours => {
            let sets: Vec<&[usize]> = rows.iter().map(|(points, ..)| &points[..]).collect();
            let colours = colours(&sets, size / 3);
            let mut order: Vec<usize> = (0..rows.len()).collect();
            order.sort_by_key(|&row| (colours[row], row));
            order
        }
        Order::Jolt => unreachable!("it has a test of its own"),
    };
    let stiff = |row: usize| all[row].iter().zip(&rows[row].1).map(|(&dof, g)| weight(dof) * g * g).sum();
    let stiff: Vec<f64> = (0..rows.len()).map(stiff).collect();
    let (mut u, mut v) = (vec![0.0; size], vec![0.0; size]);
    for _ in 0..30_000 {
        let before = u.clone();
        for dof in 0..size {
            v[dof] += h * weight(dof) * force[dof];
            if weight(dof) > 0.0 {
                u[dof] += h * v[dof];
            }
        }
        match setting.engine {
            Engine::Vbd => {
                let predicted = u.clone();
                for _ in 0..setting.iterations {
                    for p in (0..size / 3).filter(|p| weight(3 * p) > 0.0) {
                        let mut block = nalgebra::Matrix3::<f64>::identity() * (bar.masses[p] / (h * h));
                        let mut pull = nalgebra::Vector3::from_fn(|k, _| {
                            bar.masses[p] / (h * h) * (predicted[3 * p + k] - u[3 * p + k])
                        });
                        for &(row, own) in &of_point[p] {
                            let (_, g, k) = &rows[row];
                            let g = nalgebra::Vector3::from_column_slice(&g[3 * own..3 * own + 3]);
                            block += *k * g * g.transpose();
                            pull -= *k * along(row, &u) * g;
                        }
                        let step = setting.relaxation * (block.try_inverse().unwrap() * pull);
                        (0..3).for_each(|k| u[3 * p + k] += step[k]);
                    }
                }
            }
            _ => {
                let mut multipliers = vec![0.0; rows.len()];
                for _ in 0..setting.iterations {
                    let start = u.clone();
                    for &row in &order {
                        if stiff[row] == 0.0 {
                            continue;
                        }
                        let (_, g, k) = &rows[row];
                        let stretch = along(row, if setting.sweep == Sweep::Jacobi { &start } else { &u });
                        let soft = 1.0 / (k * h * h);
                        let step = -setting.relaxation * (stretch + soft * multipliers[row]) / (stiff[row] + soft);
                        multipliers[row] += step;
                        all[row].iter().zip(g).for_each(|(&dof, g)| u[dof] += weight(dof) * g * step);
                    }
                }
            }
        }
        let mut largest = 0.0_f64;
        for dof in 0..size {
            v[dof] = 0.98 * (u[dof] - before[dof]) / h;
            largest = largest.max((u[dof] - before[dof]).abs());
        }
        if largest < 3e-15 * u.iter().fold(0.0, |a: f64, u| a.max(u.abs())) {
            break;
        }
    }
    u
}

fn settings() -> Vec<Setting> {
    let xpbd = Setting::usual(Engine::Xpbd);
    let vbd = Setting { order: Order::Given, ..Setting::usual(Engine::Vbd) };
    vec![
        xpbd,
        Setting { substeps: 4, iterations: 3, order: Order::Given, ..xpbd },
        Setting { substeps: 3, iterations: 2, relaxation: 1.3, ..xpbd },
        Setting { substeps: 20, iterations: 4, sweep: Sweep::Jacobi, relaxation: 0.25, ..xpbd },
        Setting { substeps: 4, iterations: 3, ..vbd },
        Setting { substeps: 8, iterations: 2, relaxation: 0.8, ..vbd },
    ]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let square = |x: f64, y: f64| (x - y) * (x - y);
    let size: f64 = b.iter().map(|b| b * b).sum();
    (a.iter().zip(b).map(|(a, b)| square(*a, *b)).sum::<f64>() / size).sqrt()
}

#[test]
fn the_effective_stiffness_is_where_the_loop_comes_to_rest() {
    let bar = Bar::new(1);
    let force = bar.force(3);
    for setting in settings() {
        let truncated = Truncated::new(bar.model(), &bar.support, &setting).unwrap().unwrap();
        let iterated = Truncated::iterated(bar.model(), &bar.support, &setting).unwrap().unwrap();
        let wanted = settled(&bar, &setting, &force);
        for (model, most) in [(truncated, 1e-10), (iterated, 1e-9)] {
            let found = model.answers(std::slice::from_ref(&force)).unwrap().remove(0);
            assert!(distance(&found, &wanted) < most, "{}, {most:e}: {}", setting.words(), distance(&found, &wanted));
        }
    }
}

/// The steps that are timed are those of the engines: with the geometry as it moves they come to rest, under a small load, where the linear
/// theory says, of each engine by its name as well; and in the plane.
#[test]
fn the_steps_of_an_engine_come_to_rest_where_the_theory_says() {
    let bar = Bar::new(2);
    let force: Vec<f64> = bar.force(6).iter().map(|f| 0.01 * f).collect();
    let named = [Engine::Jolt, Engine::NewtonVbd].map(Setting::usual);
    for setting in settings().into_iter().chain(named) {
        let truncated = Truncated::new(bar.model(), &bar.support, &setting).unwrap().unwrap();
        let wanted = truncated.answers(std::slice::from_ref(&force)).unwrap().remove(0);
        let mut frames = Frames::new(bar.model(), &bar.support, &setting).unwrap();
        // From a shape that is not that of rest: what has been before decides nothing.
        frames.start(&wanted.iter().map(|u| -3.0 * u).collect::<Vec<f64>>());
        for _ in 0..4000 {
            frames.step(&force);
            frames.slow(0.8);
        }
        let found = frames.displacement();
        // The gradients turn by the strain, some 1e-5.
        assert!(distance(&found, &wanted) < 1e-3, "{}: {}", setting.words(), distance(&found, &wanted));
        assert!(distance(&found, &vec![0.0; found.len()]).is_infinite());
    }
    // Pulled far, springs on lengths and volumes answer with their own geometry: the loop holds the balance of its own energy, not that of the
    // linear springs.
    let setting = Setting { substeps: 40, iterations: 20, order: Order::Given, ..Setting::usual(Engine::Xpbd) };
    let force: Vec<f64> = bar.force(6).iter().map(|f| 30.0 * f).collect();
    let mut frames = Frames::new(bar.model(), &bar.support, &setting).unwrap();
    for _ in 0..600 {
        frames.step(&force);
        frames.slow(0.9);
    }
    let u = frames.displacement();
    let moved: Vec<f64> = bar.mesh.points.iter().zip(&u).map(|(x, u)| x + u).collect();
    let mut forces = vec![0.0; u.len()];
    assert!(Elastic::forces(&bar.network, &moved, &mut forces));
    let free = |dof: &usize| !bar.support.is_fixed(*dof);
    let left: f64 = (0..u.len()).filter(free).map(|dof| (forces[dof] - force[dof]).powi(2)).sum();
    let all: f64 = force.iter().map(|f| f * f).sum();
    let linear = Truncated::new(bar.model(), &bar.support, &setting).unwrap().unwrap();
    let linear = linear.answers(std::slice::from_ref(&force)).unwrap().remove(0);
    assert!(distance(&u, &linear) > 0.02, "the pull is too weak to tell: {}", distance(&u, &linear));
    assert!((left / all).sqrt() < 1e-3, "{}", (left / all).sqrt());
}

/// The gradient and the products with the Jacobian are those of differences, for springs one by one and for shared factors.
#[test]
fn derivatives_are_those_of_differences() {
    let bar = Bar::new(2);
    let mut random = Random(5);
    let targets: Vec<Target> = (0..11)
        .map(|seed| {
            let wanted: Vec<f64> = bar.force(100 + seed).iter().map(|f| 10.0 * f).collect();
            Target::new(format!("{seed}"), bar.support.clone(), bar.force(seed), wanted)
        })
        .collect();
    for setting in settings() {
        let unknowns = Unknowns::per_spring(&bar.network);
        let object = Object::new(&bar.network, &bar.mesh.points, unknowns, None).unwrap();
        let object = object.in_engine(Some((setting, &bar.masses)));
        let problem = Displacements::new(&object, targets.iter().collect(), None).unwrap();
        let theta: Vec<f64> = (0..bar.network.len()).map(|_| 0.2 * random.next()).collect();
        let direction: Vec<f64> = theta.iter().map(|_| random.next()).collect();
        let moved = |t: f64| -> Vec<f64> { theta.iter().zip(&direction).map(|(a, b)| a + t * b).collect() };
        let at = |t: f64| problem.at(&moved(t)).unwrap().unwrap();
        let h = 1e-4;
        let (value, gradient) = at(0.0).objective(0.0).unwrap();
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        // Differences of fourth order.
        let f = |t: f64| at(t).square();
        let wanted = (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
        assert!((slope - wanted).abs() < 1e-6 * slope.abs().max(1e-3 * value), "{}: {slope} {wanted}", setting.words());
        let forward = at(0.0).forward(&direction, 0.0).unwrap().concat();
        let (plus, minus) = (at(h).residuals.concat(), at(-h).residuals.concat());
        let wanted: Vec<f64> = plus.iter().zip(&minus).map(|(a, b)| (a - b) / (2.0 * h)).collect();
        assert!(distance(&forward, &wanted) < 1e-6, "{}: {}", setting.words(), distance(&forward, &wanted));
    }
}

/// With many sweeps the effective stiffness is that of the network; with few the body is softer.
#[test]
fn many_sweeps_answer_like_the_equations() {
    let bar = Bar::new(3);
    let force = bar.force(7);
    let entries = bar.network.stiffness(&bar.mesh.points);
    let equations =
        springfit_bodies::solve::Equations::factored(&entries, &bar.support, &bar.mesh.points, 3).unwrap().unwrap();
    let (exact, _) = equations.solve(&force).unwrap();
    for (engine, few) in [(Engine::Xpbd, 10), (Engine::Vbd, 1)] {
        let usual = Setting::usual(engine);
        let error = |substeps: usize, iterations: usize| {
            let setting = Setting { substeps, iterations, ..usual };
            let truncated = Truncated::new(bar.model(), &bar.support, &setting).unwrap().unwrap();
            distance(&truncated.answers(std::slice::from_ref(&force)).unwrap()[0], &exact)
        };
        assert!(error(few, 1) > 0.05, "{}", error(few, 1));
        assert!(error(20, 4000) < 1e-8, "{}", error(20, 4000));
    }
}

/// A ceiling is what springs without compliance reach; VBD has none.
#[test]
fn ceilings_are_those_of_springs_without_compliance() {
    let bar = Bar::new(4);
    let force = bar.force(2);
    let setting = Setting { substeps: 6, ..Setting::usual(Engine::Xpbd) };
    let network = bar.network.scaled(&vec![1e12; bar.network.len()]);
    let stiff = Bar { network, ..Bar::new(4) };
    let u = settled(&stiff, &setting, &force);
    let ceiling = Ceiling::of(bar.model(), &[(&bar.support, &force, &u)], &setting).unwrap().unwrap();
    assert!((ceiling.factor - 1.0).abs() < 1e-4, "{}", ceiling.factor);
    let vbd = Setting::usual(Engine::Vbd);
    assert_eq!(Ceiling::of(bar.model(), &[(&bar.support, &force, &u)], &vbd).unwrap(), None);
}

/// Springs of one colour share no point, and the order of Jolt begins with the contents.
#[test]
fn orders_are_of_all_springs() {
    let bar = Bar::new(6);
    let sets: Vec<&[usize]> = bar.network.springs().map(|(points, _)| points).collect();
    let colours = colours(&sets, bar.masses.len());
    for (i, a) in sets.iter().enumerate() {
        for (j, b) in sets.iter().enumerate().filter(|(j, _)| *j > i) {
            assert!(colours[i] != colours[j] || !a.iter().any(|p| b.contains(p)));
        }
    }
    let held: Vec<bool> = (0..bar.masses.len()).map(|p| bar.support.is_fixed(3 * p)).collect();
    let lengths = bar.network.lengths.len();
    let sequence = Sequence { springs: &sets, lengths, points: &bar.mesh.points, dimension: 3, held: &held };
    for order in Order::all() {
        let mut found = sequence.order(order);
        assert!(order != Order::Jolt || found[0] >= lengths);
        found.sort_unstable();
        assert!(found.into_iter().eq(0..sets.len()), "{}", order.name());
    }
}

/// Sweeps that take all springs at once and would grow are refused, with the substeps that end.
#[test]
fn sweeps_that_grow_are_refused() {
    let bar = Bar::new(8);
    let setting = Setting { substeps: 2, ..Setting::usual(Engine::NewtonXpbd) };
    let error = Truncated::new(bar.model(), &bar.support, &setting).unwrap_err().to_string();
    let least: usize = error.split("expected ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(Truncated::new(bar.model(), &bar.support, &setting.with_substeps(least)).unwrap().is_some(), "{error}");
}

/// A scene with this fit for an engine.
fn scene(of_fit: &str, material: &str) -> String {
    format!(
        "[mesh]\nbox = {{ size = [0.06, 0.02, 0.02], cells = [4, 2, 2], element = \"tet4\" }}\n[material]\nyoung = \"10 kPa\"\npoisson = 0.3\n\
         {material}\n[[fix]]\nwhere = \"x < 1e-6\"\n[[load]]\nname = \"pull\"\nwhere = \"x > 0.059\"\nforce = [0, 0, 1e-3]\n[[fit]]\n{of_fit}\n"
    )
}

fn run(text: &str, words: &[&str]) -> (Option<i32>, String, String) {
    let folder = holding("s.toml", text);
    let output = springfit(folder.path(), &[&["run", "s.toml"], words].concat());
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

const WHOLE: &str = "objective = \"whole\"\nstart = \"divergence\"\nsprings = [\"edge\", \"bulk\"]\n";
const DENSE: &str = "density = 1000";

/// Each wrong setting is one line with its key, the line of the file, and what was expected.
#[test]
fn wrong_settings_are_one_line() {
    let cases = [
        ("{ method = \"xpbd\", substeps = 0 }", "engine.substeps: expected a whole number from 1"),
        ("{ method = \"xpbd\", iterations = 0 }", "engine.iterations: expected a whole number from 1"),
        ("{ method = \"xpbd\", step = 0 }", "engine.step: expected a time above 0 s"),
        ("{ method = \"xpbd\", step = \"1/0 s\" }", "engine.step: expected a time above 0 s"),
        ("{ method = \"xpbd\", step = \"60 Hz\" }", "engine.step: expected a time such as"),
        ("{ method = \"unity\" }", "engine.method: expected one of xpbd, vbd, jolt"),
        ("{ substeps = 3 }", "engine.method: expected one of xpbd, vbd, jolt"),
        ("{ method = \"xpbd\", relaxation = 2 }", "engine.relaxation: expected a factor of at least 0.001 and below 2"),
        ("{ method = \"vbd\", sweep = \"jacobi\" }", "engine.sweep: expected \"gauss-seidel\", as vbd does"),
        ("{ method = \"jolt\", iterations = 3 }", "engine.iterations: expected 1: what Jolt calls iterations"),
        ("{ method = \"xpbd\", order = \"rainbow\" }", "engine.order: expected one of colours, given, jolt"),
        ("{ method = \"xpbd\", sweeps = 3 }", "engine.sweeps: unknown field"),
        ("{ method = \"xpbd\", substeps = 1 }", "engine.substeps: expected at least"),
        ("{ method = \"newton-xpbd\", substeps = 1 }", "engine.substeps: expected"),
        ("{ method = \"xpbd\", sweep = \"jacobi\", relaxation = 0.2 }", "engine.substeps: expected at least"),
        (
            "{ method = \"xpbd\", substeps = 14, sweep = \"jacobi\", relaxation = 0.3 }",
            "engine: expected sweeps with which a body that is let go comes to rest",
        ),
        (
            "{ method = \"xpbd\", relaxation = 1.95 }",
            "engine: expected sweeps with which a body that is let go comes to rest",
        ),
        (
            "{ method = \"vbd\", substeps = 4, iterations = 1, relaxation = 1.8 }",
            "engine: expected sweeps with which a body that is let go comes to rest",
        ),
        ("\"unity\"", "engine.method: expected one of xpbd, vbd, jolt"),
        ("3", "engine: invalid type: integer \"3\", expected a name such as"),
    ];
    for (engine, expected) in cases {
        let (code, _, told) = run(&scene(&format!("{WHOLE}engine = {engine}"), DENSE), &[]);
        let errors: Vec<&str> = told.lines().filter(|line| line.starts_with("error:")).collect();
        assert_eq!((code, errors.len()), (Some(2), 1), "{engine}: {told}");
        assert!(errors[0].contains(&format!("fit[0].{expected}")), "{engine}: {told}");
    }
    let engine = "engine = { method = \"xpbd\" }";
    for (fit, material, expected) in [
        ("objective = \"exact\"", DENSE, "expected springs that do not pull at rest"),
        ("objective = \"whole\"\nstart = \"exact\"", DENSE, "expected a start with springs above zero"),
        (WHOLE, "", "expected a density in [material]"),
        (WHOLE, "density = 1000\nlaw = \"stable-neo-hookean\"", "expected a material without a \"law\""),
        ("objective = \"whole\"\nfrequencies = 2", DENSE, "expected none with an \"engine\""),
    ] {
        let (code, _, told) = run(&scene(&format!("{fit}\n{engine}"), material), &[]);
        assert_eq!(code, Some(2), "{fit}: {told}");
        assert!(told.lines().any(|line| line.starts_with("error:") && line.contains(expected)), "{fit}: {told}");
    }
}

/// A network that is fitted for an engine has the displacements of the body there, and `--explain` prints the limit of the engine.
#[test]
fn a_fitted_network_answers_in_the_engine_like_the_body() {
    for method in ["xpbd", "jolt", "vbd", "newton-vbd"] {
        let engine = format!("engine = {{ method = \"{method}\", step = \"1/60 s\", substeps = 8 }}");
        let (code, table, told) = run(&scene(&format!("{WHOLE}{engine}"), DENSE), &["--json"]);
        assert_eq!(code, Some(0), "{told}");
        let report: serde_json::Value = serde_json::from_str(&table).unwrap();
        let found = &report["fits"][0]["engine"];
        let mean = |key: &str| found[key]["mean"].as_f64().unwrap();
        assert!(mean("after") < 0.6 * mean("before"), "{method}: {found}");
        let load = report["fits"][0]["loads"][0]["e_rms"].as_f64().unwrap();
        assert!(load < 8.0, "{method}: {load}");
        let (wanted, f) = (found["frequency"].as_f64().unwrap(), found["vibration"]["frequency"].as_f64().unwrap());
        assert!((f / wanted - 1.0).abs() < 0.06, "{method}: {f} {wanted}");
        assert_eq!(found["ceiling"].is_null(), method.ends_with("vbd"), "{found}");
        let (_, plan, _) = run(&scene(&format!("{WHOLE}{engine}"), DENSE), &["--explain"]);
        assert!(plan.contains("engine    whole from divergence"), "{plan}");
    }
}

/// Other fits are multiplied by one factor for springs on lengths and one for those on contents.
#[test]
fn other_fits_have_factors_for_an_engine() {
    let fit = "objective = \"divergence\"\nnonnegative = true\nsprings = [\"edge\", \"bulk\"]\nengine = { method = \"xpbd\", substeps = 8 }";
    let (code, table, told) = run(&scene(fit, DENSE), &["--json"]);
    assert_eq!(code, Some(0), "{told}");
    let report: serde_json::Value = serde_json::from_str(&table).unwrap();
    let found = &report["fits"][0]["engine"];
    assert_eq!(found["factors"].as_array().unwrap().len(), 2);
    assert!(found["after"]["mean"].as_f64() < found["before"]["mean"].as_f64(), "{found}");
}
