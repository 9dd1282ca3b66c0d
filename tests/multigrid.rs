//! Conjugate gradients with multigrid answer as a factor does, for bodies and for networks of every standing.

use crate::kit::{outcome, place};
use crate::shapes::statics::support_at;
use springfit_bodies::model::{BlockStiffness, Support, finite_elements};
use springfit_bodies::solve::{Levels, Standing, StaticMethod, StaticSolver, System};
use springfit_foundation::error::ErrorKind;
use springfit_mesh::mesh::Mesh;
use springfit_studies::study::{Hold, Outcome, Scene, run};
use std::fs;
use std::path::Path;

fn scene(text: &str, path: &Path, solver: &str) -> Scene {
    Scene::parse(&format!("{text}\n[solver]\n{solver}\n"), path).unwrap_or_else(|e| panic!("{e}"))
}

fn both(text: &str, path: &Path) -> [Outcome; 2] {
    ["method = \"cholesky\"", "method = \"multigrid\"\ntolerance = 1e-12"].map(|solver| {
        run(&scene(text, path, solver), &mut |_| ()).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    })
}

/// The largest difference as a share of the largest displacement.
fn difference(x: &[f64], y: &[f64]) -> f64 {
    let size = y.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
    x.iter().zip(y).fold(0.0, |most: f64, (x, y)| most.max((x - y).abs())) / size
}

fn product(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// What `[[fix]]` holds.
fn supports(scene: &Scene, mesh: &Mesh) -> Support {
    let d = mesh.dimension;
    let mut support = Support::free(mesh);
    for Hold { part, axes, .. } in scene.supports() {
        let all: Vec<usize> = (0..d).collect();
        let points = part.selection(d).and_then(|selection| selection.points(mesh)).unwrap();
        support.fix(&points, axes.as_ref().unwrap_or(&all), d);
    }
    support
}

/// The bound is 1e-8 of the largest displacement. The motion that is shown has the ratio that is given.
#[test]
fn shipped_scenes_have_the_same_answers() {
    let mut loads = 0;
    for name in ["cube_hex", "cube_tet", "square_quad", "tissue_quad", "tissue_tri", "specimen_quad", "cylinder_tet"] {
        let path = place(format!("scenes/{name}.toml"));
        let text = fs::read_to_string(&path).unwrap();
        let [factor, levels] = both(&text, &path);
        let scene = scene(&text, &path, "method = \"multigrid\"");
        for (x, y) in levels.loads.iter().zip(&factor.loads) {
            assert!(difference(&x.fem, &y.fem) < 1e-8, "{name}: {}: {:e}", x.name, difference(&x.fem, &y.fem));
        }
        for (x, y) in levels.fits.iter().zip(&factor.fits) {
            let what = format!("{name}: {}", x.fit.name);
            let (found, known) = (x.stability.as_ref().unwrap(), y.stability.as_ref().unwrap());
            assert_eq!(found.standing, known.standing, "{what}");
            // Both are ratios of motions, not below the least one; a search with levels ends where its ratio has settled to 1e-3 in a step.
            let [least, expected] = [found.energy_ratio[0], known.energy_ratio[0]];
            let is_stable = known.standing == Standing::Stable;
            assert!(
                !is_stable || (0.998 * expected..=1.01 * expected).contains(&least),
                "{what}: {least} and {expected}"
            );
            let support = &supports(&scene, &levels.mesh);
            let free: Vec<usize> = (0..levels.mesh.points.len()).filter(|dof| !support.is_fixed(*dof)).collect();
            let mut motion = vec![0.0; levels.mesh.points.len()];
            free.iter().zip(&found.softest).for_each(|(&dof, u)| motion[dof] = *u);
            let energy = |stiffness: &BlockStiffness| product(&motion, &stiffness.apply(&motion));
            let body = BlockStiffness::of_body(&levels.mesh, levels.material.moduli(), 1, 1).unwrap();
            let ratio = energy(&BlockStiffness::of_network(&x.network, &levels.mesh.points, None)) / energy(&body);
            assert!((ratio - least).abs() <= 1e-9 * least.abs().max(1.0), "{what}: {ratio} and {least}");
            for (x, y) in x.loads.iter().zip(&y.loads) {
                let how = x.solved_fem.as_ref().unwrap();
                assert!(how.iterations.is_some() && how.residual < 1e-8, "{what}");
                if let (Some(u), Some(known)) = (&x.displacement, &y.displacement) {
                    assert!(difference(u, known) < 1e-8, "{what}: {}: {:e}", x.name, difference(u, known));
                    loads += 1;
                }
            }
        }
    }
    assert!(loads > 20, "{loads}");
}

const BOX: &str = r#"
[mesh]
box = { element = "hex8", size = [2, 1, 1], cells = [8, 4, 4] }
[material]
young = 10e3
poisson = 0.3
[[fix]]
group = "xmin"
"#;

/// Given displacements pull forces from what is held; symmetry planes hold one direction of each point.
#[test]
fn supports_and_given_displacements_are_those_of_a_factor() {
    let text = format!(
        "{BOX}[[fix]]\ngroup = \"ymin\"\naxes = [\"y\"]\n[[fit]]\nobjective = \"modal\"\n[[load]]\ngroup = \"xmax\"\ndisplacement = \
         [0.01, \"free\", 0.002]\n[[load]]\ngroup = \"zmax\"\ntraction = [0, 0, 5.0]\n"
    );
    let [factor, levels] = both(&text, Path::new("scene.toml"));
    for (x, y) in levels.fits[0].loads.iter().zip(&factor.fits[0].loads) {
        assert!(difference(x.displacement.as_ref().unwrap(), y.displacement.as_ref().unwrap()) < 1e-8);
        assert!((x.work_error.unwrap() - y.work_error.unwrap()).abs() < 1e-6);
        assert!((x.error.unwrap().rms - y.error.unwrap().rms).abs() < 1e-6);
    }
    assert_eq!(levels.fits[0].loads.len(), 2);
}

/// Every tolerance that the key accepts is one that an answer may have.
#[test]
fn an_answer_is_as_good_as_was_asked() {
    let text = format!(
        "{BOX}[[fit]]\nobjective = \"modal\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [3, 0, 1]\n[[load]]\n\
         group = \"xmax\"\ndisplacement = [0.01, \"free\", 0]\n"
    );
    let solved =
        |tolerance: &str| outcome(&format!("{text}[solver]\nmethod = \"multigrid\"\ntolerance = {tolerance}\n"));
    let known = solved("1e-12");
    for tolerance in ["1e-7", "1e-6", "1e-5", "1e-4", "9e-4"] {
        let found = solved(tolerance);
        let bound: f64 = tolerance.parse().unwrap();
        for (found, known) in found.loads.iter().zip(&known.loads) {
            // The norm of the energy weighs the long motions of this bar less than a norm of displacements.
            assert!(difference(&found.fem, &known.fem) < 10.0 * bound, "{tolerance}: {}", known.name);
        }
        assert!(found.fits[0].loads.iter().all(|load| load.displacement.is_some()), "{tolerance}");
    }
}

/// A network that has negative springs and one without springs across are not called stable, whatever solves.
#[test]
fn networks_that_do_not_stand_are_shown() {
    // Edges alone: each cell shears freely.
    let edges = format!(
        "{BOX}[[fit]]\nobjective = \"frobenius\"\nsprings = [\"edge\"]\n[[load]]\ngroup = \"xmax\"\nforce = [0, 0, 1.0]\n"
    );
    // Nearly incompressible: springs across push.
    let push = edges.replace("poisson = 0.3", "poisson = 0.49").replace("springs = [\"edge\"]\n", "");
    let mut seen = Vec::new();
    for text in [&edges, &push] {
        let [factor, levels] = both(text, Path::new("scene.toml"));
        let standing = |outcome: &Outcome| outcome.fits[0].stability.as_ref().unwrap().standing;
        assert_eq!(standing(&levels), standing(&factor));
        assert_eq!(levels.fits[0].status(), factor.fits[0].status());
        let [known, found] = [&factor, &levels].map(|outcome| outcome.fits[0].loads[0].displacement.as_ref());
        assert_eq!(known.is_some(), found.is_some());
        if let (Some(known), Some(found)) = (known, found) {
            assert!(difference(found, known) < 1e-8, "{}", difference(found, known));
        }
        if standing(&factor) != Standing::Stable {
            assert!(!levels.fits[0].loose_points.is_empty());
        }
        seen.push(standing(&factor));
    }
    assert!(seen.contains(&Standing::Singular), "{seen:?}");
}

/// The product with blocks is that with the list of entries, for bodies and networks.
#[test]
fn blocks_are_the_sums_of_the_entries() {
    for (name, cells) in
        [("hex8", vec![3, 2, 2]), ("tet10", vec![2, 2, 1]), ("quad4", vec![4, 3]), ("tri3", vec![4, 3])]
    {
        let text = format!(
            "[mesh]\nbox = {{ element = \"{name}\", size = {:?}, cells = {cells:?} }}\n[material]\nyoung = 3\npoisson = 0.3\n[[fit]]\nobjective \
             = \"modal\"\n",
            vec![1.5; cells.len()]
        );
        let scene = Scene::parse(&text, Path::new("scene.toml")).unwrap();
        let outcome = run(&scene, &mut |_| ()).unwrap();
        let (mesh, network) = (&outcome.mesh, &outcome.fits[0].network);
        let support = Support::free(mesh);
        let u: Vec<f64> = (0..mesh.points.len()).map(|i| ((i * i) % 17) as f64 - 8.0).collect();
        let body = BlockStiffness::of_body(mesh, outcome.material.moduli(), 1, 1).unwrap();
        let pairs = [
            (body.apply(&u), finite_elements(mesh, outcome.material.moduli())),
            (BlockStiffness::of_network(network, &mesh.points, Some(&body)).apply(&u), network.stiffness(&mesh.points)),
            (BlockStiffness::of_network(network, &mesh.points, None).apply(&u), network.stiffness(&mesh.points)),
        ];
        for (found, entries) in pairs {
            let expected = System::new(&entries, &support).unwrap().apply(&u);
            assert!(difference(&found, &expected) < 1e-14, "{name}");
        }
    }
}

/// A body that is held at one point turns about it.
#[test]
fn levels_show_the_motion_that_meets_no_resistance() {
    let scene = Scene::parse(&format!("{BOX}[[fit]]\nobjective = \"modal\"\n"), Path::new("scene.toml")).unwrap();
    let outcome = run(&scene, &mut |_| ()).unwrap();
    let mesh = &outcome.mesh;
    let support = support_at(mesh, &[0]);
    let stiffness = BlockStiffness::of_body(mesh, outcome.material.moduli(), 1, 1).unwrap();
    let motion = match Levels::new(stiffness.clone(), &mesh.points, &support).unwrap() {
        Err(motion) => motion,
        Ok(levels) => levels.prove().unwrap().expect("it is not positive definite"),
    };
    let force = stiffness.apply(&motion);
    let energy: f64 = motion.iter().zip(&force).map(|(u, f)| u * f).sum();
    let size: f64 = motion.iter().map(|u| u * u).sum();
    assert!(energy.abs() <= 1e-9 * size * outcome.material.uniform().unwrap().young());
}

#[test]
fn the_method_is_chosen_by_size_and_by_the_number_of_loads() {
    let solver = StaticSolver::default();
    let scene = |n: usize| {
        let text = BOX.replace("cells = [8, 4, 4]", &format!("cells = [{n}, {n}, {n}]"));
        Scene::parse(&format!("{text}[[fit]]\nobjective = \"modal\"\n"), Path::new("scene.toml"))
            .unwrap()
            .build_mesh()
            .unwrap()
    };
    let (small, large) = (scene(8), scene(22));
    assert!(!solver.iterates(&small, 1) && solver.iterates(&large, 100) && !solver.iterates(&large, 200));
    assert!(StaticSolver { method: StaticMethod::Multigrid, ..solver }.iterates(&small, 100));
    assert!(!StaticSolver { method: StaticMethod::Cholesky, ..solver }.iterates(&large, 1));
}

#[test]
fn keys_of_the_solver_are_checked() {
    let text =
        format!("{BOX}[[fit]]\nobjective = \"modal\"\n[[load]]\ngroup = \"xmax\"\nforce = [0, 0, 1.0]\n[solver]\n");
    for (keys, expected) in [
        ("method = \"amg\"", "solver.method: expected one of auto, cholesky, multigrid, found \"amg\""),
        ("tolerance = 0.0", "solver.tolerance: expected a share from 1e-14 to below 1e-3, found 0.0"),
        ("tolerance = 1.0", "solver.tolerance: expected a share from 1e-14 to below 1e-3, found 1.0"),
        ("iterations = 0", "solver.iterations: expected"),
        ("method = \"cholesky\"\ntolerance = 1e-8", "solver.tolerance: belongs to iterations"),
        ("methode = \"auto\"", "solver.methode: unknown field"),
    ] {
        let error = Scene::parse(&format!("{text}{keys}\n"), Path::new("scene.toml")).unwrap_err().to_string();
        assert!(error.contains(expected), "{keys}: {error}");
    }
    let few =
        Scene::parse(&format!("{text}method = \"multigrid\"\niterations = 1\n"), Path::new("scene.toml")).unwrap();
    let error = run(&few, &mut |_| ()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Limit);
    assert_eq!(error.key(), Some("solver.iterations"));
    let words = ["stall", "levels: 225 × 3", "more of them", "solver.tolerance", "solver.method = \"cholesky\""];
    assert!(words.iter().all(|word| error.to_string().contains(word)), "{error}");
}
