//! Networks in JSON, as springfit writes them.

use super::file::{SpecimenFile, SpecimenOptions};
use crate::error::Result;
use crate::material::Plane;
use crate::model::{Specimen, Support};
use crate::network::reader::parse;
use crate::network::record::NodalLoadRecord;
use crate::text::rounded;

pub fn read(bytes: &[u8], options: &SpecimenOptions) -> Result<SpecimenFile> {
    let record = parse(bytes)?;
    let d = record.dimension;
    let network = record.model(&options.elements)?;
    let mut prescribed = vec![None; record.points.len() * d];
    for held in &record.held {
        let at = &mut prescribed[held.point * d..][..d];
        at.iter_mut().zip(&held.displacement).for_each(|(all, own)| *all = own.map(|_| 0.0));
    }
    let forces = |load: &NodalLoadRecord| {
        let mut all = vec![0.0; record.points.len() * d];
        for force in &load.forces {
            all[force.point * d..][..d].iter_mut().zip(&force.force).for_each(|(all, own)| *all += own);
        }
        all
    };
    let moves =
        |load: &&NodalLoadRecord| load.held.iter().any(|held| held.displacement.iter().flatten().any(|u| *u != 0.0));
    let loads = record.loads.iter().filter(|load| !moves(load)).map(forces);
    let loads: Vec<Vec<f64>> = loads.filter(|load| load.iter().any(|f| *f != 0.0)).collect();
    let specimen = Specimen {
        masses: record.masses.clone(),
        mesh: record.mesh(&options.elements),
        support: (!record.held.is_empty()).then_some(Support { prescribed }),
        loads,
        ..Specimen::new(network, record.points.concat())
    };
    // Files of before have the state where the material is the same everywhere.
    let of_material = || {
        record.provenance.material.as_ref().and_then(|material| match material.state.as_str() {
            "plane stress" => Some((Plane::Stress, material.thickness)),
            "plane strain" => Some((Plane::Strain, material.thickness)),
            _ => None,
        })
    };
    let state = record.plane.map(|plane| (plane.state, plane.thickness)).or_else(of_material);
    let varying = record.plane.filter(|plane| plane.varies).map(|plane| {
        format!(
            "the thickness differs from cell to cell: figures are those with its mean, {} m",
            rounded(plane.thickness, 4)
        )
    });
    let plain = SpecimenFile::plain(specimen, "springfit, JSON");
    let notes = varying.into_iter().chain(record.notes.iter().cloned()).collect();
    Ok(SpecimenFile { state, engine: record.engine, notes, ..plain })
}
