//! What relaxes and is damped: measured damping with what was fitted to it, and moduli over frequency.

use super::table::Digits::{Signed, Significant};
use super::table::Priority::{Always, InFiles};
use super::table::{Cell, Column, Table};
use crate::study::{ComplexModulus, DynamicModuli, DynamicModuliOutcome, MeasuredDamping};

/// One row for each measurement.
pub(super) fn damping(all: &[MeasuredDamping]) -> Table {
    let fitted = |measured: &MeasuredDamping| match measured.rayleigh {
        Some([mass, stiffness]) => format!("alpha = {mass:.4e} 1/s, beta = {stiffness:.4e} s"),
        None => format!("Prony series of {} terms", measured.terms.len()),
    };
    let number = |value| Cell::number(Some(value), Significant(4));
    let column = |title, group| Column::numbers(title).group(group).priority(Always);
    let between =
        "Between frequencies that were measured, the damping ratio is on a line over the logarithm of the frequency.";
    let constant = |measured: &MeasuredDamping| {
        measured
            .is_constant
            .then(|| format!("{}: one number was measured, which is taken as constant over the band.", measured.key))
    };
    let decay = |measured: &MeasuredDamping| {
        let error = measured.decay_error?;
        Some(format!("{}: ln of the amplitudes is off the line of an even decay by {error:.2e} (rms).", measured.key))
    };
    let notes = all.iter().any(|measured| !measured.is_constant).then(|| between.to_string());
    let notes =
        notes.into_iter().chain(all.iter().flat_map(|measured| [constant(measured), decay(measured)]).flatten());
    let table = Table::of(
        "damping",
        "Damping that was measured, over a band of frequencies",
        all,
        &[
            (Column::words("measured"), &|measured| measured.key.as_str().into()),
            (Column::words("fitted").priority(Always), &|measured| fitted(measured).into()),
            (column("from", "band").unit("Hz"), &|measured| number(measured.band[0])),
            (column("to", "band").unit("Hz"), &|measured| number(measured.band[1])),
            (column("measured", "damping ratio"), &|measured| number(measured.ratio)),
            (column("largest", "off by"), &|measured| number(measured.largest_difference)),
            (column("rms", "off by"), &|measured| number(measured.rms_difference)),
        ],
    );
    table.with_notes(notes.collect::<Vec<_>>())
}

/// One row for each model and frequency; the moduli of the material stand beside.
pub(super) fn dynamic_moduli(outcome: Option<&DynamicModuliOutcome>) -> Table {
    let has_bulk = outcome
        .into_iter()
        .flat_map(|outcome| &outcome.models)
        .any(|model| model.moduli.as_ref().is_some_and(|moduli| moduli.bulk.is_some()));
    let mut kinds: Vec<(&str, Kind)> = vec![("E", |moduli| Some(&moduli.young)), ("G", |moduli| Some(&moduli.shear))];
    if has_bulk {
        kinds.push(("K", |moduli| moduli.bulk.as_ref()));
    }
    let mut columns = vec![Column::words("model"), Column::numbers("f").unit("Hz").priority(Always)];
    for (place, (name, _)) in kinds.iter().enumerate() {
        // The terminal has the modulus of tension.
        let priority = if place == 0 { Always } else { InFiles };
        for (part, title) in [("storage", "'"), ("loss", "''")] {
            let group = format!("{name}{title} ({part})");
            let titled = |title: &str, unit| Column::numbers(title).unit(unit).group(&*group).priority(priority);
            columns.extend([titled("model", "Pa"), titled("material", "Pa"), titled("off", "%")]);
        }
    }
    let rows = outcome.into_iter().flat_map(|outcome| {
        let kinds = &kinds;
        outcome.models.iter().flat_map(move |model| {
            outcome.frequency.iter().enumerate().filter(|_| model.moduli.is_some()).map(move |(i, frequency)| {
                let mut row = vec![Cell::from(&*model.name), Cell::number(Some(*frequency), Significant(4))];
                for (_, kind) in kinds {
                    let of = |moduli: Option<&DynamicModuli>, part: fn(&ComplexModulus) -> &Vec<f64>| {
                        part(kind(moduli?)?).get(i).copied()
                    };
                    let parts: [fn(&ComplexModulus) -> &Vec<f64>; 2] =
                        [|modulus| &modulus.storage, |modulus| &modulus.loss];
                    for part in parts {
                        let (own, asked) = (of(model.moduli.as_ref(), part), of(outcome.material.as_ref(), part));
                        let off =
                            own.zip(asked).filter(|(_, asked)| *asked != 0.0).map(|(own, asked)| own / asked - 1.0);
                        row.extend([own, asked].map(|value| Cell::number(value, Significant(5))));
                        row.push(Cell::percent(off, Signed(2)));
                    }
                }
                row
            })
        })
    });
    let without = outcome
        .into_iter()
        .flat_map(|outcome| &outcome.models)
        .filter_map(|model| Some(format!("{} has no moduli over frequency: {}.", model.name, model.reason.as_ref()?)));
    let title = "Storage and loss moduli under harmonic stress, without inertia";
    Table::new("dynamic_moduli", title, columns, rows.collect::<Vec<_>>()).with_notes(without.collect::<Vec<_>>())
}

/// One of the moduli.
type Kind = fn(&DynamicModuli) -> Option<&ComplexModulus>;
