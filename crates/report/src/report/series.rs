//! Motions as series of pictures that ParaView plays.

use super::pictures::{cell_grid, spring_grid, vectors};
use crate::error::Result;
use crate::file::{Edition, write_whole};
use crate::mesh::vtk;
use crate::model::displaced;
use crate::study::{ModelMotion, Outcome};
use crate::text::xml;

/// Writes the states of a model as `STEM/0000.vtu`, …, the points where they are then, and last the collection `STEM.pvd` that
/// names them with their times.
///
/// # Errors
/// A file cannot be written.
pub fn write_series(outcome: &Outcome, model: &ModelMotion, stem: &str, edition: &mut Edition) -> Result<()> {
    let mesh = &outcome.mesh;
    let digits = model.states.len().saturating_sub(1).to_string().len().max(4);
    let mut sets = String::new();
    for (i, (u, record)) in model.states.iter().zip(&model.records).enumerate() {
        let x = displaced(&mesh.points, u);
        let mut grid = match model.fit {
            None => cell_grid(mesh, &x),
            Some(fit) => spring_grid(mesh, &outcome.fits[fit].network, &x),
        };
        grid.point_data.push(vectors("u (m)".into(), u, mesh.dimension));
        let name = format!("{stem}/{i:0digits$}.vtu");
        edition.write(&name, |path| vtk::write(path, &grid))?;
        let time = format!("{:.12e}", record.account.time).parse::<f64>().unwrap_or(record.account.time);
        sets += &format!("    <DataSet timestep=\"{time}\" file=\"{}\"/>\n", xml(&name));
    }
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  \
         <Collection>\n{sets}  </Collection>\n</VTKFile>\n"
    );
    edition.write(&format!("{stem}.pvd"), |path| write_whole(path, text.as_bytes()))
}
