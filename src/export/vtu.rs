//! VTU: a picture of the network for ParaView.

use super::relaxes::Relaxes;
use super::target::{Content, EVERY_ENGINE, NamedFile, Stands, Target, nothing};
use springfit_foundation::error::{Error, Result};
use springfit_mesh::mesh::vtk::{Array, Grid};
use springfit_report::report::NetworkRecord;

const LINE: u8 = 3;
const POINTS: u8 = 2;

/// What this program holds, and how a network is written for it.
pub const TARGET: Target = Target {
    name: "vtu",
    title: "springs as lines with their constants, for ParaView",
    command: "",
    leaves_out: nothing,
    has_loads: false,
    divides: false,
    engines: EVERY_ENGINE,
    relaxes: Relaxes::Passed,
    stands: Stands::Still,
    write,
};

fn write(network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
    if gravity.is_some() {
        return Err(Error::at(
            "--gravity",
            "belongs to programs that move the network, found it with vtu, which is a picture",
        ));
    }
    Ok(vec![("network.vtu", Content::Grid(Box::new(grid(network))))])
}

fn grid(network: &NetworkRecord) -> Grid {
    let spatial = |x: &Vec<f64>| std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0));
    let mut grid = Grid { points: network.points.iter().map(spatial).collect(), ..Grid::default() };
    for spring in &network.springs {
        let kind = if spring.kind == "length" { LINE } else { POINTS };
        grid.push_cell(kind, &spring.points);
    }
    let scalar = |name: &str, values: Vec<f64>| Array { name: name.into(), components: 1, values };
    let of = |value: fn(&springfit_report::report::SpringRecord) -> f64| network.springs.iter().map(value).collect();
    grid.cell_data = vec![
        scalar("k", of(|s| s.constant)),
        scalar("rest", of(|s| s.rest)),
        scalar("damper", of(|s| s.damper)),
        scalar("is_length", of(|s| f64::from(u8::from(s.kind == "length")))),
    ];
    let mut held = vec![0.0; network.points.len()];
    network.held.iter().for_each(|given| held[given.point] = 1.0);
    grid.point_data.push(scalar("held", held));
    grid.point_data.extend(network.masses.clone().map(|masses| scalar("mass (kg)", masses)));
    grid
}
