//! What a reader must know of sheets and rods that bend.

use super::note::{Note, Weight};
use crate::model::hinge_flexure;
use crate::study::{FitOutcome, Outcome};
use nalgebra::Matrix3;

/// The thickness, relative to the extent of a body, beyond which shear across it counts.
// At a tenth shear adds 0.8 % to the deflection of a cantilever's end and 12 % to that of the middle of a beam that is
// clamped at both ends, as `E/(4 κ G) (t/L)²` and 16 times that with `κ = 5/6` and Poisson's ratio 0.3.
const THICK: f64 = 0.1;

/// That the sheet is thick, and how hinges bend.
pub(super) fn sheet_notes(outcome: &Outcome) -> Vec<Note> {
    thick(outcome).into_iter().chain(flexure(outcome)).collect()
}

/// That the theory of thin plates and slender rods leaves out what a thick one does.
fn thick(outcome: &Outcome) -> Option<Note> {
    let directors = outcome.mesh.directors.as_ref()?;
    let gyration = directors.gyration.iter().copied().fold(0.0, f64::max);
    // The square of the radius of gyration is t²/12 of a plate, and d²/16 of a round rod.
    let (body, thickness) = match outcome.mesh.cell_dimension() {
        1 => ("rod", 4.0 * gyration.sqrt()),
        _ => ("sheet", (12.0 * gyration).sqrt()),
    };
    let size = outcome.mesh.longest_side();
    (thickness > THICK * size).then(|| {
        let words = format!(
            "the {body} is {thickness:.3e} m thick and extends over {size:.3e} m: the theory of thin plates and slender rods leaves out shear across the thickness, which \
             counts beyond a tenth of the extent; cells that fill the body know it"
        );
        Note::of_body(Weight::Reference, words)
    })
}

/// How a sheet with hinges bends, beside the plate.
fn flexure(outcome: &Outcome) -> Vec<Note> {
    let note = |fit: &FitOutcome| {
        let hinged = hinge_flexure(&outcome.mesh, &fit.network)?;
        let plate = Matrix3::from_row_slice(&outcome.material.moduli().uniform()?.entries(2).0);
        let plate = plate * outcome.mesh.directors.as_ref()?.gyration[0];
        let words = |d: &Matrix3<f64>| {
            let ratio = d[(0, 1)] / (d[(0, 0)] * d[(1, 1)]).sqrt();
            let [xx, yy, xy] = [d[(0, 0)], d[(1, 1)], d[(2, 2)]];
            format!("D_xx = {xx:.3e}, D_yy = {yy:.3e}, D_xy = {xy:.3e} N·m and a Poisson's ratio of {ratio:.3}")
        };
        let [own, asked] = [words(&hinged), words(&plate)];
        let words = format!("the hinges bend as a plate with {own} on average");
        let note = Note::of_model(Weight::Model, &fit.fit.name, words);
        Some(note.advice(format!("; the plate has {asked}, as springs on directors do")))
    };
    outcome.fits.iter().filter_map(note).collect()
}
