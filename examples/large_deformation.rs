//! A neo-Hookean cube under large loads: networks fitted to the stiffness at rest beside networks fitted to forces at sampled
//! shapes, all solved at large deformation. %e_rms against the hyperelastic finite elements.

use springfit::element::Element;
use springfit::error::Result;
use springfit::fit::{CellFits, Fit, Objective, Sampling, Weight, fit_cells, fit_sampled};
use springfit::material::{Energy, Material, State};
use springfit::mesh::{BoxMesh, Mesh, Selection};
use springfit::model::{Action, Body, Elastic, Network, Support, nodal_forces};
use springfit::solve::{Ending, Newton};
use springfit::springs::Springs;
use springfit::study::displacement_error;
use std::sync::Arc;

/// Tractions on the top in units of E: tension, shear.
const LOADS: [[f64; 3]; 2] = [[0.0, 0.0, 0.35], [0.1, 0.0, 0.0]];

fn main() -> Result<()> {
    println!("{:8} {:7} {:24} {:>16} {:>16}", "element", "springs", "fit", "tension 0.35 E", "shear 0.1 E");
    for (name, cells) in [("hex8", 4), ("tet4", 3)] {
        let element = Arc::new(Element::load(name)?);
        study(&BoxMesh { element, size: vec![1.0; 3], cells: vec![cells; 3], origin: vec![0.0; 3] }.build()?)?;
    }
    Ok(())
}

fn study(mesh: &Mesh) -> Result<()> {
    let block = &mesh.blocks[0];
    let (element, points, cells) = (&block.element, &mesh.points, &block.connectivity);
    let material = Material::new(1.0, 0.3, State::Solid)?;
    let energy = Energy::load("neo-hookean", material)?;
    let mut support = Support::free(mesh);
    support.fix(&Selection::Group("zmin".into()).points(mesh)?, &[0, 1, 2], 3);
    let top = Selection::Group("zmax".into());
    let solve = |model: &dyn Elastic| -> Result<Vec<Option<Vec<f64>>>> {
        let one = |load: &[f64; 3]| {
            let forces = nodal_forces(mesh, &top, &Action::Traction(load.to_vec()), 1.0)?;
            let found = Newton { steps: 2, ..Newton::default() }.solve(model, points, &support, &forces)?;
            Ok(Some(found.displacement).filter(|_| found.ending == Ending::Converged))
        };
        LOADS.iter().map(one).collect()
    };
    let body = solve(&Body { mesh, energy: &energy, state: State::Solid })?;
    let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
    for groups in [None, Some(&every[..])] {
        let springs = Springs::select(element, groups)?;
        let at_rest = |objective: Objective| {
            let fit = Fit { nonnegative: true, ..Fit::new(objective) };
            fit_cells(element, &springs, points, cells, material.moduli(), &fit, &mut |_| {})
        };
        let row = |fit: String, fits: CellFits| -> Result<()> {
            let lattice = solve(&Network::assemble(mesh, &[fits]))?;
            let error = |(fem, lem): (&Option<Vec<f64>>, &Option<Vec<f64>>)| {
                let error = displacement_error(fem.as_ref()?, lem.as_ref()?, 3)?;
                Some(format!("{:.2}", error.rms))
            };
            let errors = body.iter().zip(&lattice).map(|pair| error(pair).unwrap_or("no equilibrium".into()));
            let errors: Vec<String> = errors.collect();
            println!("{:8} {:7} {fit:24} {:>16} {:>16}", element.name, springs.len(), errors[0], errors[1]);
            Ok(())
        };
        let weights = [Weight::None, Weight::OffDiagonal, Weight::Modal { higher: 0.316 }];
        let objectives = weights.map(Objective::Frobenius).into_iter().chain([Objective::Divergence { balance: 0.25 }]);
        for objective in objectives {
            row(objective.title() + ", k >= 0", at_rest(objective)?)?;
        }
        let sampling = Sampling { stretch: 0.3, perturbation: 0.02, ..Sampling::default() };
        let sampled = fit_sampled(element, &springs, points, cells, &energy, State::Solid, &sampling, true)?;
        let fits = CellFits { constants: sampled.constants, ..at_rest(Objective::Frobenius(Weight::None))? };
        row("sampled, k >= 0".into(), fits)?;
    }
    Ok(())
}
