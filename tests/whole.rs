//! The whole-object fit: its gradient, and what it does for loads that it has not seen.

use springfit::fit::{Fit, Objective, Weight, fit_cells};
use springfit::material::Material;
use springfit::mesh::{Mesh, Selection};
use springfit::model::{Network, Support, finite_elements};
use springfit::report;
use springfit::solve::System;
use springfit::springs::Springs;
use springfit::study::{LoadOutcome, Scene, displacement_error, run};
use springfit::whole::{Problem, Target, WholeSettings, fit_whole, standard_loads};
use std::path::Path;

/// The body of a scene, held as there, with the standard loads and their finite element displacements.
struct Case {
    mesh: Mesh,
    material: Material,
    support: Support,
    targets: Vec<Target>,
}

fn case(name: &str, held: &str, face: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
    let scene = Scene::load(&path).unwrap();
    let mesh = scene.build_mesh().unwrap();
    let material = scene.material(mesh.cell_dimension()).unwrap();
    let [held, face] = [held, face].map(|name| Selection::Group(name.into()));
    let mut support = Support::free(&mesh);
    let all: Vec<usize> = (0..mesh.dimension).collect();
    support.fix(&held.points(&mesh).unwrap(), &all, mesh.dimension);
    let loads = standard_loads(&mesh, &held, &face, material.thickness()).unwrap();
    let system = System::new(&finite_elements(&mesh, material.moduli()), &support).unwrap();
    let factor = system.factorize().unwrap();
    let target = |load: springfit::whole::NodalLoad| {
        let displacement = system.solve(&factor, &load.forces).0;
        Target { name: load.name.into(), forces: load.forces, displacement, weight: 1.0 }
    };
    let targets = loads.into_iter().map(target).collect();
    Case { mesh, material, support, targets }
}

impl Case {
    fn network(&self, objective: Objective, bulk: bool) -> Network {
        let fit = Fit { nonnegative: true, ..Fit::new(objective) };
        let of_block = |block: &springfit::mesh::CellBlock| {
            let every: Vec<String> = block.element.springs.iter().map(|g| g.name.clone()).collect();
            let springs = Springs::select(&block.element, bulk.then_some(&every)).unwrap();
            let moduli = self.material.moduli();
            fit_cells(&block.element, &springs, &self.mesh.points, &block.connectivity, moduli, &fit, &mut |_| {})
                .unwrap()
        };
        let fits: Vec<_> = self.mesh.blocks.iter().map(of_block).collect();
        Network::assemble(&self.mesh, &fits)
    }

    /// Held out: bending and gravity to the side.
    fn split(&self) -> (Vec<Target>, Vec<Target>) {
        self.targets.clone().into_iter().partition(|t| !["bending", "side gravity"].contains(&t.name.as_str()))
    }

    /// %e_rms of each target.
    fn errors(&self, network: &Network, targets: &[Target]) -> Vec<f64> {
        let system = System::new(&network.stiffness(&self.mesh.points), &self.support).unwrap();
        let factor = system.factorize().unwrap();
        let error = |t: &Target| {
            let u = system.solve(&factor, &t.forces).0;
            displacement_error(&t.displacement, &u, self.mesh.dimension).unwrap().rms
        };
        targets.iter().map(error).collect()
    }
}

/// Against central differences, springs of all kinds among the unknowns.
#[test]
fn the_gradient_is_that_of_differences() {
    let case = case("tissue_tri", "fixed", "load");
    let network = case.network(Objective::Frobenius(Weight::None), true);
    let problem = Problem::new(&network, &case.mesh.points, &case.support, 0.1).unwrap();
    let mut theta = problem.start().to_vec();
    theta.iter_mut().enumerate().for_each(|(i, t)| *t += 0.1 * (i as f64).sin());
    let value = |theta: &[f64]| problem.evaluate(theta, &case.targets).unwrap().unwrap().value;
    let gradient = problem.evaluate(&theta, &case.targets).unwrap().unwrap().gradient;
    let largest = gradient.iter().fold(0.0f64, |a, g| a.max(g.abs()));
    for i in (0..theta.len()).step_by(theta.len() / 40) {
        let moved = |h: f64| {
            let mut theta = theta.clone();
            theta[i] += h;
            value(&theta)
        };
        let slope = (moved(1e-4) - moved(-1e-4)) / 2e-4;
        assert!((slope - gradient[i]).abs() < 1e-6 * largest, "{i}: {slope} {}", gradient[i]);
    }
}

/// Tension, shears and torsion are fitted; bending and gravity only choose the regularization.
#[test]
fn whole_fits_lower_the_errors_of_loads() {
    let plain = Objective::Frobenius(Weight::None);
    for (name, held, face, objective, bulk) in [
        ("tissue_quad", "fixed", "load", plain, false),
        ("cube_tet", "fixed", "load", plain, false),
        ("cube_tet", "fixed", "load", Objective::Divergence { balance: 0.25 }, true),
        ("cylinder_hole_tet", "fixed", "load", plain, false),
        ("cylinder_hole_tet", "fixed", "load", Objective::Divergence { balance: 0.25 }, true),
        ("cube_hex", "zmin", "zmax", Objective::Frobenius(Weight::OffDiagonal), false),
    ] {
        let case = case(name, held, face);
        let network = case.network(objective, bulk);
        let (trained, others) = case.split();
        let mut problem = Problem::new(&network, &case.mesh.points, &case.support, 0.0).unwrap();
        let start = std::time::Instant::now();
        let found = fit_whole(&mut problem, &trained, &others, &WholeSettings::default()).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        let [before, after] = [&network, &found.network].map(|n| (case.errors(n, &trained), case.errors(n, &others)));
        println!(
            "{name}: {} springs, {:.2} s, {} evaluations, rho {:.0e}, constants change by up to {:.1}\n  fitted {:.2?} -> {:.2?}\n  others {:.2?} -> {:.2?}",
            network.len(),
            seconds,
            found.evaluations,
            found.regularization,
            found.change,
            before.0,
            after.0,
            before.1,
            after.1
        );
        assert!(after.1.iter().zip(&before.1).all(|(a, b)| a < b), "{name}");
        assert!(found.change < 1000.0);
    }
}

/// Through a scene: loads that neither the fit nor its regularization has seen come out better, and the notes say which were seen.
#[test]
fn scenes_fit_the_whole_object() {
    let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cube_tet_whole.toml")).unwrap();
    let outcome = run(&scene, &mut |_, _, _| {}).unwrap();
    for (before, after) in [(0, 1), (2, 3)] {
        let [before, after] = [before, after].map(|i| &outcome.fits[i].loads);
        for held_out in ["gravity along y", "one half pulled"] {
            let error = |loads: &[LoadOutcome]| loads.iter().find(|l| l.name == held_out).unwrap().error.unwrap().rms;
            assert!(error(after) < 0.5 * error(before), "{held_out}: {} {}", error(before), error(after));
        }
    }
    assert!(outcome.fits.iter().all(|fit| fit.network.negative() == 0));
    let notes = report::notes(&outcome);
    assert!(
        notes.iter().any(|note| note.contains("fitted to tension, shear x, shear y, whose errors are not held out"))
    );
    assert!(report::report(&outcome).contains("\"validated\""));
}
