//! What a whole-object fit costs: its gradient beside one solve per load, and fits of boxes up to a hundred thousand springs.

use springfit_bodies::model::{Network, Support, finite_elements};
use springfit_bodies::solve::System;
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_identify::whole::{
    Displacements, LeastSquares, NodalLoad, Object, Target, Unknowns, Validation, Wanted, WholeSettings, fit_whole,
    made_loads, random_loads,
};
use springfit_mesh::mesh::BoxMesh;
use std::sync::Arc;
use std::time::Instant;

/// The median seconds of five runs.
fn median(mut run: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[2]
}

/// The largest memory this process has had, MB, where the system tells.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn main() {
    let material = Material::new(10e3, 0.3, State::Solid).expect("it is valid");
    println!(
        "{:8} {:>8} {:>6} {:>6} {:>16} {:>14} {:>6} {:>9} {:>10} {:>8}",
        "cells", "springs", "dofs", "loads", "solve per load", "and gradient", "ratio", "fit", "error", "memory"
    );
    for (name, side) in [("tet4", 6), ("hex8", 8), ("tet4", 16), ("hex8", 14), ("hex8", 20)] {
        let element = Arc::new(Element::load(name).expect("it is shipped"));
        let spec = BoxMesh { element, size: vec![0.02; 3], cells: vec![side; 3], origin: vec![0.0; 3] };
        let mesh = spec.build().expect("its cells fill a box");
        let mut support = Support::free(&mesh);
        support.fix(&mesh.groups["zmin"].points, &[0, 1, 2], 3);
        let system = System::new(&finite_elements(&mesh, material.moduli()), &support).expect("it fits into memory");
        let factor = system.cholesky().unwrap().expect("the body is held");
        let targets = |loads: Vec<NodalLoad>| -> Vec<Target> {
            let forces: Vec<Vec<f64>> = loads.iter().map(|load| load.forces.clone()).collect();
            let of = |(load, displacement): (NodalLoad, Vec<f64>)| {
                Target::new(load.name, support.clone(), load.forces, displacement)
            };
            loads.into_iter().zip(system.solve_all(&factor, &forces)).map(of).collect()
        };
        let trained = targets(made_loads(&mesh, &support, 1.0));
        let validation = Validation::Loads(targets(random_loads(&mesh, &support, 1.0, 4, 2010)));
        let block = &mesh.blocks[0];
        let springs = Springs::select(&block.element, None).expect("no group is named");
        let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
        let (points, cells) = (&mesh.points, &block.connectivity);
        let fits = fit_cells(&block.element, &springs, points, cells, material.moduli(), &fit, &mut |_| {});
        let network = Network::assemble(&mesh, &[fits.expect("every cell has a volume")]);
        let object = Object::new(&network, points, Unknowns::per_spring(&network), None).expect("it has springs");
        let theta = vec![0.0; network.len()];
        let problem = Displacements::new(&object, trained.iter().collect(), None).expect("all loads move something");
        let at = || problem.at(&theta).expect("it fits into memory").expect("it stands");
        // The first analyses the pattern.
        at();
        let solve = median(|| drop(at()));
        let gradient = median(|| drop(at().objective(1e-3).unwrap()));
        drop(problem);
        let (dofs, loads) = (system.size(), trained.len());
        let wanted = Wanted { trained, validation, ..Wanted::default() };
        let start = Instant::now();
        let found = fit_whole(&object, &wanted, &WholeSettings::default(), None, &mut |_| true).expect("it stands");
        let seconds = start.elapsed().as_secs_f64();
        let mean = |errors: &[f64]| 100.0 * errors.iter().sum::<f64>() / errors.len() as f64;
        println!(
            "{name:4} {side:2}^3 {:>8} {dofs:>6} {loads:>6} {:>13.1} ms {:>11.1} ms {:>6.2} {seconds:>7.1} s {:>4.1}>{:3.1} % {:>5.0} MB",
            network.len(),
            1e3 * solve,
            1e3 * gradient,
            gradient / solve,
            mean(&found.validated[0].loads),
            mean(&found.validated[1].loads),
            peak().unwrap_or(f64::NAN),
        );
    }
}
