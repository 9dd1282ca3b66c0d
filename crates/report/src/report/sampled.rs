//! The data of a sampled fit as tables: the error of each shape, and the end of each start.

use crate::study::SampledOutcome;
use std::io::{self, Write};

/// The errors of each shape of one cell of each shape. Errors are relative to the force of the shape, or to that of a small strain where
/// it is less; numbers of blocks, cells, sets and shapes are from 0.
///
/// # Errors
/// The writer fails.
pub fn shapes_csv(outcome: &SampledOutcome, to: &mut dyn Write) -> io::Result<()> {
    writeln!(to, "block,cell,part,set,shape,family,least_det,least_stretch,largest_stretch,force (N),error")?;
    for (block, errors) in outcome.errors.iter().enumerate() {
        for one in errors {
            let [least, largest] = one.stretches;
            let place = format!("{block},{},{},{},{}", one.cell, one.part.name(), one.set, one.shape);
            let strains = format!("{:e},{least:e},{largest:e}", one.content);
            writeln!(to, "{place},{},{strains},{:e},{:e}", one.family, one.force, one.error)?;
        }
    }
    Ok(())
}

/// Where each start ended in one cell of each shape; a law that is linear in its parameters has one start.
///
/// # Errors
/// The writer fails.
pub fn starts_csv(outcome: &SampledOutcome, to: &mut dyn Write) -> io::Result<()> {
    writeln!(to, "block,cell,start,error,steps,converged,distance")?;
    for (block, ends) in outcome.ends.iter().enumerate() {
        for one in ends {
            let end = one.end;
            let place = format!("{block},{},{}", one.cell, one.start);
            writeln!(to, "{place},{:e},{},{},{:e}", end.error, end.steps, end.converged, end.distance)?;
        }
    }
    Ok(())
}
