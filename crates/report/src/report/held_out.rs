//! The errors of whole-object fits under loads that no fit has seen, as a table.

use super::json::Report;
use super::table::Digits::Fixed;
use super::table::Priority::Always;
use super::table::{Cell, Column, Table};
use crate::order::distinct;

/// One row for each model: the finite elements of the mesh, its exact networks, the network at the start and the fitted one; and a group of columns
/// for each support. What is the same for several fits, as the finite elements are, has one row.
pub(super) fn held_out(report: &Report) -> Table {
    let all = || report.fits.iter().filter_map(|fit| fit.whole.as_ref()).flat_map(|whole| &whole.held_out);
    let places = distinct(all().map(|held_out| held_out.column()));
    let loads = distinct(all().map(|held_out| held_out.loads));
    let mut columns = vec![Column::words("model").priority(Always), Column::words("fit").priority(Always)];
    for place in &places {
        let group = format!("held at {place}");
        columns.extend(
            ["median", "largest"].map(|title| Column::numbers(title).unit("%").group(group.as_str()).priority(Always)),
        );
    }
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut shared: Vec<(String, Vec<Option<f64>>)> = Vec::new();
    for fit in &report.fits {
        let Some(whole) = &fit.whole else { continue };
        let models = whole.held_out.iter().flat_map(|held_out| &held_out.models);
        for model in distinct(models.map(|model| model.model.as_str())) {
            let errors = places.iter().flat_map(|place| {
                let own = whole.held_out.iter().find(|held_out| held_out.column() == *place);
                let found = own.and_then(|held_out| held_out.models.iter().find(|own| own.model == model));
                [found.and_then(|own| own.median), found.and_then(|own| own.worst)]
            });
            let errors: Vec<Option<f64>> = errors.collect();
            let is_of_fit = ["start", "fitted"].contains(&model);
            let known = (model.to_string(), errors.clone());
            if !is_of_fit && shared.contains(&known) {
                continue;
            }
            let name = if is_of_fit { fit.name.clone() } else { String::new() };
            shared.push(known);
            let cells = errors.into_iter().map(|error| Cell::percent(error, Fixed(2)));
            rows.push([Cell::from(model), Cell::from(&*name)].into_iter().chain(cells).collect());
        }
    }
    let count = match loads[..] {
        [one] => format!("{one} other loads"),
        _ => "other loads".into(),
    };
    Table::new("unseen", format!("Whole-object fits: errors under {count}, which no fit has seen"), columns, rows)
}
