//! A comparison that has been read: its cases and its fits.

use super::axes::{VariedFit, varied_fits};
use super::entry::{CompareEntry, CompareFile, numbers};
use super::sets::shape_sets;
use crate::analysis::shapes::ShapeSet;
use crate::bound::{self, check_count};
use crate::element::Element;
use crate::error::{Error, Result, expect_none};
use crate::file::{self, Sum};
use crate::fit::Solver;
use crate::material::{Energy, Material, Plane};
use crate::springs::Springs;
use serde_json::{Value, json};
use springfit_scenes::{Scene, Setting, law_at, load_elements};
use std::collections::{BTreeMap, HashSet};
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Young's modulus of the elements, Pa; errors do not depend on it.
pub(super) const YOUNG: f64 = 10e3;
/// Elements have this Poisson's ratio if the comparison gives none.
const POISSON: f64 = 0.3;
/// Cases of elements at most: each is fitted by every fit, and has a line of its own in the files.
const MOST_CASES: f64 = 1e5;
/// The largest stretch of sampled shapes where no fit is listed.
pub(super) const STRETCH: f64 = 0.35;

/// A comparison that has been read and checked.
#[derive(Debug)]
pub struct Comparing {
    pub(super) title: Option<String>,
    /// The table, as it identifies the comparison on disk.
    text: String,
    folder: PathBuf,
    /// The file and its text, if the comparison is in one.
    source: Option<(PathBuf, String)>,
    pub(super) cases: Vec<Case>,
    /// The fits that are listed; none if all that are usual are compared.
    pub(super) fits: Vec<VariedFit>,
    pub(super) iterations: u64,
    pub(super) stretch: f64,
    pub(super) is_timed: bool,
}

/// One case: what all fits are compared on.
#[derive(Debug)]
pub struct Case {
    /// What the case is, by the keys that cases differ in.
    pub settings: BTreeMap<String, Value>,
    pub(super) subject: Subject,
}

/// What a case is of.
#[derive(Debug)]
pub(super) enum Subject {
    /// Shapes of an element.
    Shapes { element: Arc<Element>, material: Material, set: ShapeSet },
    /// A box of an element that is stretched.
    Box { element: Arc<Element>, material: Material, law: String },
    /// A scene.
    Scene(Box<Scene>),
}

impl Comparing {
    /// Reads the comparison in a file.
    ///
    /// # Errors
    /// The file, or one that it names, is missing or wrong; the error names file, line and key.
    pub fn load(path: &Path) -> Result<Comparing> {
        Comparing::parse(&file::read_text(path)?, path)
    }

    /// Reads a comparison as [`Comparing::load`] does, from a text that is at `path`, to which other files are relative.
    ///
    /// # Errors
    /// As there.
    pub fn parse(text: &str, path: &Path) -> Result<Comparing> {
        let read = || {
            let file: CompareFile = file::parse_toml(text)?;
            let table: toml::Table = text.parse().map_err(|e| Error::new(format!("is not TOML: {e}")))?;
            let folder = path.parent().unwrap_or(Path::new(""));
            let comparing = Comparing::of(&file.compare, table.get("compare"), (folder, &[]));
            let source = Some((path.into(), text.into()));
            Ok(Comparing { title: file.title, source, ..comparing.map_err(|e| e.placed(|e| e.under("compare")))? })
        };
        read().map_err(|e: Error| e.placed(|e| file::on_line_of_key(e, text).in_file(path)))
    }

    /// Reads the keys of `[compare]` without a file; paths are relative to `folder`, and scenes have these other values of keys.
    ///
    /// # Errors
    /// A key is wrong, or a file that is named.
    pub fn of_table(table: toml::Table, folder: &Path, settings: &[Setting]) -> Result<Comparing> {
        let entry: CompareEntry = file::parse_table(table.clone())?;
        Comparing::of(&entry, Some(&toml::Value::Table(table)), (folder, settings))
    }

    fn of(
        entry: &CompareEntry,
        table: Option<&toml::Value>,
        (folder, settings): (&Path, &[Setting]),
    ) -> Result<Comparing> {
        let fits = varied_fits(&entry.fit, folder)?;
        let iterations = entry.iterations.unwrap_or(Solver::DEFAULT_ITERATIONS);
        check_count("iterations", iterations, 1, bound::SEARCH_ITERATIONS)?;
        if entry.elements.is_empty() && entry.scenes.is_empty() {
            return Err(Error::expected("elements", "elements or \"scenes\" to compare on", "none"));
        }
        if entry.stretch.is_some() && entry.laws.is_empty() {
            return Err(Error::at("stretch", "belongs to a comparison with laws"));
        }
        if entry.shapes.is_some() && !entry.laws.is_empty() {
            return Err(Error::at("shapes", "belongs to a comparison without laws"));
        }
        let mut cases = element_cases(entry, folder)?;
        for (place, path) in entry.scenes.iter().enumerate() {
            let key = format!("scenes[{place}]");
            expect_file(&key, &folder.join(path))?;
            let at = |e: Error| e.placed(|e| e.at_key(key));
            let scene = Scene::load_with(&folder.join(path), settings).map_err(at)?;
            let settings = BTreeMap::from([("scene".to_string(), json!(path.to_string_lossy()))]);
            cases.push(Case { settings, subject: Subject::Scene(Box::new(scene)) });
        }
        let mut known = HashSet::new();
        let is_again = |case: &&Case| !known.insert(serde_json::to_string(&case.settings).unwrap_or_default());
        if let Some(again) = cases.iter().find(is_again) {
            return Err(Error::new(format!("expected each case once, found {} again", again.words())));
        }
        for case in &cases {
            case.check(&fits)?;
        }
        let text = table.map(without_cases).transpose()?.unwrap_or_default();
        Ok(Comparing {
            title: None,
            text,
            folder: folder.into(),
            source: None,
            cases,
            fits,
            iterations,
            stretch: entry.stretch.unwrap_or(STRETCH),
            is_timed: entry.time != Some(false),
        })
    }

    /// The title.
    pub fn title(&self) -> Option<&str> {
        self.title.as_deref()
    }

    /// The cases in their order.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// The names of the fits that are listed; none if all that are usual are compared.
    pub fn fit_names(&self) -> Vec<&str> {
        self.fits.iter().map(|fit| fit.named.name.as_str()).collect()
    }

    /// The files that the comparison reads.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut all: Vec<PathBuf> = self.cases.iter().flat_map(|case| case.inputs(&self.folder)).collect();
        all.sort();
        all.dedup();
        all
    }

    /// An error of a fit in a scene as one of the fits of the comparison, which stand in place of those of the scene.
    pub(super) fn of_fit(&self, error: Error) -> Error {
        let Some(key) = error.key().filter(|key| key.starts_with("fit[") && !self.fits.is_empty()) else {
            return error;
        };
        let own = Error::at(format!("compare.{key}"), error.problem()).of_kind(error.kind());
        match &self.source {
            Some((path, text)) => own.placed(|e| file::on_line_of_key(e, text).in_file(path)),
            None => Error::at(format!("--{key}"), error.problem()).of_kind(error.kind()),
        }
    }

    /// A sum of all that a case depends on: its settings, the fits, the files that it names and the version of the program.
    pub fn sum(&self, case: &Case) -> String {
        let mut sum = Sum::default();
        // Another version may compute other numbers: its cases are run again.
        sum.write(env!("CARGO_PKG_VERSION").as_bytes());
        sum.write(self.text.as_bytes());
        sum.write(serde_json::to_string(&case.settings).unwrap_or_default().as_bytes());
        for path in case.inputs(&self.folder) {
            // A file that cannot be read fails in the case.
            // The sum of each file has a fixed length, so that text which moves from the end of one file to the start
            // of the next changes the total.
            sum.write(&Sum::of_file(&path).unwrap_or_default().finish().to_le_bytes());
        }
        format!("{:016x}", sum.finish())
    }
}

/// The table without what only says which cases there are, so that a comparison can be extended.
fn without_cases(table: &toml::Value) -> Result<String> {
    let mut table = table.clone();
    if let Some(table) = table.as_table_mut() {
        ["elements", "poisson", "shapes", "laws", "scenes"].iter().for_each(|key| drop(table.remove(*key)));
    }
    serde_json::to_string(&table).map_err(|e| Error::new(format!("has a value that JSON has not: {e}")))
}

/// That a path leads to a file.
fn expect_file(key: &str, path: &Path) -> Result<()> {
    match path.is_file() {
        true => Ok(()),
        false => Err(Error::expected(key, "the path of a file", format!("\"{}\"", path.display()))),
    }
}

/// The cases of all elements.
fn element_cases(entry: &CompareEntry, folder: &Path) -> Result<Vec<Case>> {
    if entry.elements.is_empty() {
        let given = [
            ("poisson", entry.poisson.is_some()),
            ("plane", entry.plane.is_some()),
            ("shapes", entry.shapes.is_some()),
        ];
        let belongs =
            "belongs to elements, found without them: a scene has its own, and [compare] takes several scenes";
        return expect_none(given, belongs).map(|()| Vec::new());
    }
    for (place, name) in entry.elements.iter().enumerate().filter(|(_, name)| name.ends_with(".toml")) {
        expect_file(&format!("elements[{place}]"), &folder.join(name))?;
    }
    let elements = load_elements(&entry.elements, folder)?;
    let ratios = numbers("poisson", entry.poisson.as_ref(), POISSON)?;
    let sets = shape_sets(entry.shapes.as_ref())?;
    // Counted before any material is made, and in floating point, which does not wrap.
    let all = elements.len() as f64 * ratios.len() as f64 * (sets.len().max(entry.laws.len())) as f64;
    if all > MOST_CASES {
        return Err(Error::expected("elements", format!("at most {MOST_CASES} cases"), format!("{all}")));
    }
    let mut cases = Vec::new();
    for (name, element) in entry.elements.iter().zip(elements) {
        let d = element.dimension();
        for ratio in &ratios {
            // A list may have plane and solid elements: the state is that of the plane ones.
            let plane = entry.plane.filter(|_| d == 2);
            let material = Material::for_body(d, YOUNG, *ratio, plane, None)?;
            let mut settings = BTreeMap::from([("element".to_string(), json!(name)), ("poisson".into(), json!(ratio))]);
            if d == 2 {
                let plane = if entry.plane == Some(Plane::Strain) { "strain" } else { "stress" };
                settings.insert("plane".into(), json!(plane));
            }
            for (place, law) in entry.laws.iter().enumerate() {
                // What is wrong with a law is found before the work.
                let at = |e: Error| e.placed(|e| Error::at(format!("laws[{place}]"), e.problem()));
                Energy::load(&law_at(law, folder), material).map_err(at)?;
                let settings = settings.clone().into_iter().chain([("law".to_string(), json!(law))]).collect();
                let (element, law) = (element.clone(), law_at(law, folder));
                cases.push(Case { settings, subject: Subject::Box { element, material, law } });
            }
            for set in sets.iter().filter(|_| entry.laws.is_empty()) {
                let own = [
                    ("family", json!(set.family.name())),
                    ("distortion", json!(set.distortion)),
                    ("aspect", json!(set.aspect)),
                    ("seed", json!(set.seed)),
                    ("count", json!(set.count)),
                ];
                let own = own.map(|(key, value)| (key.to_string(), value));
                let settings = settings.clone().into_iter().chain(own).collect();
                let subject = Subject::Shapes { element: element.clone(), material, set: *set };
                cases.push(Case { settings, subject });
            }
        }
    }
    Ok(cases)
}

impl Case {
    /// The files that the case reads.
    fn inputs(&self, folder: &Path) -> Vec<PathBuf> {
        let named = |key: &str| {
            let name = self.settings.get(key).and_then(Value::as_str).filter(|name| name.ends_with(".toml"));
            name.map(|name| folder.join(name))
        };
        match &self.subject {
            Subject::Scene(scene) => scene.inputs(),
            Subject::Shapes { .. } | Subject::Box { .. } => named("element").into_iter().chain(named("law")).collect(),
        }
    }

    /// Checks what can be wrong with the fits on this case and is not found by trying.
    fn check(&self, fits: &[VariedFit]) -> Result<()> {
        let (Subject::Shapes { element, .. } | Subject::Box { element, .. }) = &self.subject else {
            let Subject::Scene(scene) = &self.subject else { return Ok(()) };
            return scene.check_fits(&fits.iter().map(|fit| fit.named.clone()).collect::<Vec<_>>());
        };
        for fit in fits {
            let key = fit.named.entry().map_or("fit".into(), |entry| format!("fit[{entry}]"));
            Springs::select(element, fit.named.springs.as_deref()).map_err(|e| e.placed(|e| e.under(&key)))?;
            let is_of_cells = fit.named.recipe.kind().cell_method().is_some();
            if matches!(self.subject, Subject::Shapes { .. }) && !is_of_cells {
                let expected = "a fit of single elements, for \"elements\" are compared without \"laws\"";
                return Err(Error::expected(key, expected, format!("\"{}\"", fit.named.name)));
            }
        }
        Ok(())
    }

    /// The case in words: its values in the order of their keys.
    pub fn words(&self) -> String {
        let word = |(key, value): (&String, &Value)| match value {
            Value::String(text) if key == "element" || key == "scene" => text.clone(),
            Value::String(text) => format!("{key} {text}"),
            value => format!("{key} {value}"),
        };
        self.settings.iter().map(word).collect::<Vec<_>>().join(", ")
    }
}

/// Whether the text is that of a comparison: a table with `compare`.
pub fn is_comparison(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("compare"))
}
