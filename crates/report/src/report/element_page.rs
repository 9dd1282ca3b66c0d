//! A page of elements: pictures of their nodes and springs, and their constants in closed form.

use super::derivation::{Derivation, named};
use super::figure::cell_picture;
use super::names::file_stems;
use super::table::{Column, Table, markdown_body};
use super::write_files;
use crate::element::{Element, SpringGroup};
use crate::error::Result;
use crate::file::Edition;
use crate::fit::{ClosedFit, ClosedForm, Weight};
use crate::material::Plane;
use crate::springs::Springs;
use crate::study::{Event, Progress};
use crate::text::markdown;
use std::fmt::Write;
use std::path::PathBuf;

/// The page; pictures are beside it.
const PAGE: &str = "elements.md";
/// Elements of more nodes take up to minutes to derive.
const MOST_NODES: usize = 10;
const WEIGHTS: [(Weight, &str); 2] = [(Weight::None, "frobenius"), (Weight::OffDiagonal, "offdiag")];

const HEAD: &str = "\
# Elements in pictures

The reference cell of each element: its nodes with their numbers, the springs of each group, and the spring constants of the fits `frobenius` and
`offdiag` as formulas; plane elements are in plane stress. Edges behind a cell are dashed. Fits use the groups in parentheses only where they
name them. `springfit elements --out FOLDER` writes this page and its pictures, and `springfit elements my_element.toml --out FOLDER` those of
an element of your own. `springfit derive` prints formulas of rectangles and boxes, of orthotropic materials, and in LaTeX.
";

/// The names of the files that [`write_element_page`] writes.
pub fn element_page_files(elements: &[Element]) -> Vec<String> {
    let stems = file_stems(elements.iter().map(|element| element.name.as_str()));
    std::iter::once(PAGE.to_string()).chain(stems.iter().map(|stem| format!("{stem}.svg"))).collect()
}

/// Writes a page in Markdown, and a picture of each element as SVG.
///
/// # Errors
/// An element has no springs; or a file cannot be written, and the folder is as it was.
pub fn write_element_page(elements: &[Element], edition: Edition, progress: &mut Progress) -> Result<Vec<PathBuf>> {
    let names = element_page_files(elements);
    let (mut page, mut pictures) = (HEAD.to_string(), Vec::new());
    for (i, (element, picture)) in elements.iter().zip(&names[1..]).enumerate() {
        progress(Event::stage(&element.name, i, elements.len()));
        page += &section(element, picture)?;
        pictures.push((picture.clone(), cell_picture(element)));
    }
    let files: Vec<(String, String)> = std::iter::once((names[0].clone(), page)).chain(pictures).collect();
    write_files(edition, &files)
}

fn section(element: &Element, picture: &str) -> Result<String> {
    let (name, title, nodes) = (markdown(&element.name), markdown(&element.title), element.nodes());
    let mut text = format!("\n## {name}\n\n{title}, {nodes} nodes.\n\n![Nodes and springs of {name}]({picture})\n\n");
    if element.nodes() > MOST_NODES {
        text += &markdown_body(&groups(element));
        writeln!(
            text,
            "\n`springfit derive {}` prints its constants; it takes from ten seconds to minutes.",
            element.name
        )
        .expect("a String grows");
        return Ok(text);
    }
    let springs = Springs::select(element, None)?;
    let form = match ClosedForm::new(element, &springs, false) {
        Ok(form) => form,
        Err(error) => {
            text += &markdown_body(&groups(element));
            writeln!(text, "\n{}.", markdown(&error.to_string())).expect("a String grows");
            return Ok(text);
        }
    };
    let fits: Vec<_> = WEIGHTS.iter().map(|(weight, _)| form.fit(*weight)).collect();
    let plane = (element.dimension() == 2).then_some(Plane::Stress);
    let derivation = Derivation { element, form: &form, exact: None, fits: &fits, plane, matrix: false };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (i, class) in form.classes.iter().enumerate() {
        let constant = |fit: &Result<ClosedFit>| match fit {
            Ok(fit) => derivation.constant(&fit.constants[i]),
            Err(_) => "-".into(),
        };
        let like = named(&class.group, &class.springs[0]);
        let row = [like, class.springs.len().to_string()].into_iter().chain(fits.iter().map(constant));
        rows.push(row.collect());
    }
    for group in element.springs.iter().filter(|group| group.optional) {
        let none = [format!("({})", group.name), group.nodes.len().max(1).to_string()];
        rows.push(none.into_iter().chain(fits.iter().map(|_| String::new())).collect());
    }
    let constants = WEIGHTS.map(|(_, name)| Column::words(format!("k, {name}")));
    let columns = [Column::words("springs"), Column::numbers("of a cell")].into_iter().chain(constants).collect();
    text += &markdown_body(&Table::new("constants", name, columns, rows));
    let errors = fits.iter().zip(WEIGHTS).filter_map(|(fit, (_, name))| {
        let error = derivation.relative_error(fit.as_ref().ok()?)?;
        Some(format!("{error:.3} ({name})"))
    });
    let errors: Vec<String> = errors.collect();
    writeln!(text, "\n‖R − K‖/‖R‖ at ν = 0.3: {}.", errors.join(", ")).expect("a String grows");
    for error in fits.iter().filter_map(|fit| fit.as_ref().err()) {
        writeln!(text, "\n{}.", markdown(&error.to_string())).expect("a String grows");
    }
    Ok(text)
}

/// The groups of springs, those that are optional in parentheses.
fn groups(element: &Element) -> Table {
    let columns = vec![Column::words("springs"), Column::numbers("of a cell")];
    let row = |group: &SpringGroup| {
        let name = match group.nodes.first() {
            Some(first) => named(&group.name, first),
            None => group.name.clone(),
        };
        let name = if group.optional { format!("({})", group.name) } else { name };
        vec![name, group.nodes.len().max(1).to_string()]
    };
    Table::new("springs", element.name.clone(), columns, element.springs.iter().map(row))
}
