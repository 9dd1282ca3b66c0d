//! Runs the experiments of a paper.

use super::index::{Column, Index, Kind, RowEntry, TableEntry};
use super::material::material;
use super::outcome::{Paper, PaperRow, PaperScene, PaperTable};
use super::surface::{of_surface, surface};
use crate::error::{Error, Result};
use crate::file::{create_folder, on_line_of_key, read_text, write_whole};
use crate::solve::{Ending, Standing};
use crate::study::compare::{MethodOutcome, measure_recipes};
use crate::study::run::run;
use springfit_scenes::{
    Event, FitOutcome, ModelMotion, MotionEnding, NamedFit, Outcome, Progress, Recipe, Scene, expect_own_name,
    load_element,
};
use springfit_shipped::EXPERIMENTS;
use std::path::{Path, PathBuf};

/// The path of the index among the shipped experiments.
const INDEX: &str = "paper/index.toml";
/// The number of random shapes of each element that is timed, that of the paper.
const SHAPES: usize = 100;
/// Poisson's ratio of the elements that are timed.
const POISSON: f64 = 0.3;
/// Young's modulus of the elements that are timed, Pa.
const YOUNG: f64 = 10e3;

/// Checks that what is in `folder` are the shipped experiments, or nothing.
///
/// # Errors
/// A file there has been changed.
pub fn check_experiments(folder: &Path) -> Result<()> {
    let differs =
        |(name, text): &&(&str, &str)| std::fs::read(folder.join(name)).is_ok_and(|old| old != text.as_bytes());
    if let Some((name, _)) = EXPERIMENTS.iter().find(differs) {
        let index = folder.join(INDEX);
        let problem = "differs from the shipped file, which would replace it: run what is there with --index";
        return Err(Error::new(format!("{problem} {}, or move it away", index.display())).in_file(&folder.join(name)));
    }
    Ok(())
}

/// Writes the shipped experiments into `folder`, and returns the path of their index.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_experiments(folder: &Path) -> Result<PathBuf> {
    for (name, text) in EXPERIMENTS {
        let path = folder.join(name);
        create_folder(path.parent().unwrap_or(folder))?;
        write_whole(&path, text.as_bytes())?;
    }
    Ok(folder.join(INDEX))
}

impl Index {
    /// The index of the shipped experiments.
    ///
    /// # Errors
    /// None; a test proves it.
    pub fn shipped() -> Result<Index> {
        let text = EXPERIMENTS.iter().find(|(name, _)| *name == INDEX).map_or("", |(_, text)| text);
        Index::parse(text)
    }
}

/// Runs the tables with these names, or all, of the index at `path`. Its scenes are relative to it, and each is run
/// once.
///
/// # Errors
/// A table is unknown, a scene or an element is wrong, or a figure is printed for a fit that does not exist.
pub fn run_paper(index: &Index, names: &[String], path: &Path, progress: &mut Progress) -> Result<Paper> {
    index.expect(names)?;
    let mut paper = Paper { title: index.title.clone(), tables: Vec::new(), scenes: Vec::new() };
    for (i, table) in index.table.iter().enumerate() {
        if !names.is_empty() && !names.contains(&table.name) {
            continue;
        }
        let found = paper.run(table, path.parent().unwrap_or(Path::new("")), progress);
        // If the index is a file, its text gives the line.
        let text = || read_text(path).unwrap_or_default();
        let placed = |e: Error| on_line_of_key(e.under(format!("table[{i}]")), &text()).in_file(path);
        paper.tables.push(found.map_err(|e| e.placed(placed))?);
    }
    Ok(paper)
}

impl Paper {
    fn run(&mut self, table: &TableEntry, folder: &Path, progress: &mut Progress) -> Result<PaperTable> {
        let mut rows = Vec::new();
        let mut surfaces = Vec::new();
        let entries = table.fit.iter().enumerate().map(|(i, fit)| {
            let fits = fit.fits(folder).map_err(|e| e.placed(|e| e.under(format!("fit[{i}]"))));
            fits.map(|mut fits| fits.remove(0))
        });
        let fits: Vec<NamedFit> = entries.collect::<Result<_>>()?;
        for (i, fit) in fits.iter().enumerate() {
            expect_own_name(&format!("fit[{i}].name"), &fit.name, fits[..i].iter().map(|fit| fit.name.as_str()))?;
        }
        for (j, row) in table.row.iter().enumerate() {
            let at = |e: Error| e.placed(|e| e.under(format!("row[{j}]")));
            let of_row = |what: &str| format!("table {}, {}: {what}", table.name, row.object);
            let mut of_row = |event: Event| match event {
                Event::Stage { name, done, total } => progress(Event::stage(&of_row(name), done, total)),
                Event::Note(note) => progress(Event::Note(&of_row(note))),
            };
            let own = match table.kind {
                Kind::Scenes | Kind::Motion => {
                    let scene = self.scene(row, folder, &mut of_row);
                    let outcome = &scene?.outcome;
                    if table.kind == Kind::Motion { of_motion(row, outcome) } else { of_scene(table, row, outcome) }
                }
                Kind::Timing => timed(row, &fits, folder, &mut of_row),
                Kind::Surface => {
                    let (young, poisson) = (table.young.unwrap_or_default(), table.poisson.unwrap_or_default());
                    let found = surface(row, &fits, young, poisson, folder).map_err(at)?;
                    let own = found.iter().map(|surface| of_surface(table, row, surface)).collect();
                    surfaces.extend(found);
                    Ok(own)
                }
            };
            let mut own = own.map_err(at)?;
            if let Some(fit) = row.printed.keys().find(|fit| own.iter().all(|row| row.fit != **fit)) {
                let names: Vec<&str> = own.iter().map(|row| row.fit.as_str()).collect();
                let expected = format!("a fit of the object ({})", names.join(", "));
                return Err(at(Error::expected("printed", expected, format!("\"{fit}\""))));
            }
            for own in &mut own {
                own.printed = row.printed.get(&own.fit).cloned();
                own.why = table.why(row, &own.fit).filter(|_| own.differs());
            }
            rows.extend(own);
        }
        let TableEntry { name, title, note, load, columns, .. } = table.clone();
        Ok(PaperTable { name, title, note, load, columns, rows, surfaces })
    }

    /// The outcome of the row's scene, which is run when it is first needed.
    fn scene(&mut self, row: &RowEntry, folder: &Path, progress: &mut Progress) -> Result<&PaperScene> {
        let file = row.scene.as_deref().unwrap_or(Path::new(""));
        let stem = row.stem().unwrap_or_default();
        let known = self.scenes.iter().position(|scene| scene.stem == stem);
        let place = match known {
            Some(place) => place,
            None => {
                let scene = Scene::load(&folder.join(file))?;
                self.scenes.push(PaperScene { stem, outcome: run(&scene.judged_by_cells(), progress)? });
                self.scenes.len() - 1
            }
        };
        Ok(&self.scenes[place])
    }
}

/// A row for each fit of the scene.
fn of_scene(table: &TableEntry, row: &RowEntry, outcome: &Outcome) -> Result<Vec<PaperRow>> {
    let load = table.load.as_deref().unwrap_or_default();
    let of_fit = |fit: &FitOutcome| {
        let found = fit.loads.iter().find(|l| l.name == load).ok_or_else(|| {
            let names: Vec<&str> = fit.loads.iter().map(|load| load.name.as_str()).collect();
            Error::expected(
                "scene",
                format!("a scene with the load \"{load}\""),
                format!("those of {}", names.join(", ")),
            )
        })?;
        let figure = |column: &Column| match column {
            Column::ERms => found.error.map(|e| e.rms),
            Column::EMax => found.error.map(|e| e.max),
            Column::Young => found.gauge.map(|g| g.young),
            Column::Poisson => found.gauge.map(|g| g.poisson),
            Column::Seconds | Column::Frames | Column::YoungRatio | Column::PoissonShift => None,
        };
        let figures = table.columns.iter().map(figure).collect();
        let published = fit.fit.recipe.published().is_some();
        let stands = match found.followed {
            Some(followed) => followed.ending == Ending::Converged,
            None => fit.stability.as_ref().is_some_and(|s| s.standing == Standing::Stable),
        };
        Ok(PaperRow::new(row, &fit.fit.name, figures, published, stands))
    };
    outcome.fits.iter().map(of_fit).collect()
}

/// A row for each fit of the scene, with the speed of its motion.
fn of_motion(row: &RowEntry, outcome: &Outcome) -> Result<Vec<PaperRow>> {
    let missing = || Error::expected("scene", "a scene with a [motion]", "one without");
    let motion = outcome.motion.as_ref().ok_or_else(missing)?;
    let networks = motion.models.iter().filter_map(|model| Some((&outcome.fits[model.fit?], model)));
    let of_model = |(fit, model): (&FitOutcome, &ModelMotion)| {
        let complete = model.ending == MotionEnding::Complete;
        let published = fit.fit.recipe.published().is_some();
        let speed = Some(model.steps_per_second()).filter(|_| complete);
        PaperRow::new(row, &fit.fit.name, vec![speed], published, complete)
    };
    Ok(networks.map(of_model).collect())
}

fn timed(row: &RowEntry, fits: &[NamedFit], folder: &Path, progress: &mut Progress) -> Result<Vec<PaperRow>> {
    let element = load_element(row.element.as_deref().unwrap_or_default(), folder)?;
    let recipes: Vec<Recipe> = fits.iter().map(|fit| fit.recipe.clone()).collect();
    let material = material(element.dimension(), YOUNG, POISSON)?;
    let outcomes = measure_recipes(&element, material, SHAPES, &recipes, progress)?;
    let of = |(fit, found): (&NamedFit, &MethodOutcome)| {
        let published = fit.recipe.published().is_some();
        PaperRow::new(row, &fit.name, vec![found.times.as_ref().map(|times| times.median)], published, true)
    };
    Ok(fits.iter().zip(&outcomes).map(of).collect())
}
