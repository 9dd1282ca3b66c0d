//! Motions as series of pictures that ParaView plays.

use super::pictures::{cell_grid, spring_grid, vectors};
use crate::error::Result;
use crate::file::{create_folder, write_whole};
use crate::mesh::vtk;
use crate::model::displaced;
use crate::study::{ModelMotion, Outcome};
use crate::text::xml;
use std::path::{Path, PathBuf};

/// Writes the states of a model as `STEM/0000.vtu`, …, the points where they are then, and last the collection `STEM.pvd` that
/// names them with their times; returns the path of the collection.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_series(outcome: &Outcome, model: &ModelMotion, stem: &str, folder: &Path) -> Result<PathBuf> {
    let mesh = &outcome.mesh;
    let own = folder.join(stem);
    create_folder(&own)?;
    let digits = model.states.len().saturating_sub(1).to_string().len().max(4);
    let mut sets = String::new();
    for (i, (u, record)) in model.states.iter().zip(&model.records).enumerate() {
        let x = displaced(&mesh.points, u);
        let mut grid = match model.fit {
            None => cell_grid(mesh, &x),
            Some(fit) => spring_grid(mesh, &outcome.fits[fit].network, &x),
        };
        grid.point_data.push(vectors("u (m)".into(), u, mesh.dimension));
        let name = format!("{i:0digits$}.vtu");
        vtk::write(&own.join(&name), &grid)?;
        let time = format!("{:.12e}", record.account.time).parse::<f64>().unwrap_or(record.account.time);
        sets += &format!("    <DataSet timestep=\"{time}\" file=\"{}/{name}\"/>\n", xml(stem));
    }
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  \
         <Collection>\n{sets}  </Collection>\n</VTKFile>\n"
    );
    let path = folder.join(format!("{stem}.pvd"));
    write_whole(&path, text.as_bytes())?;
    Ok(path)
}
