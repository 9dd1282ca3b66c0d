//! `springfit compare`.

use super::output::OutputOptions;
use super::scene_file::{Settings, is_scene};
use super::state::State;
use crate::terminal::Terminal;
use clap::{Args, ValueEnum};
use serde::Serialize;
use springfit_element::element::Element;
use springfit_element::material::Material;
use springfit_foundation::error::{Error, Result};
use springfit_foundation::file::Edition;
use springfit_report::report::{self, CASES, COMPARE_FILES, Comparison, StudyLines, Table};
use springfit_studies::study::{self, CaseRecord, Comparing, Event, Forecast, MethodRecord, is_comparison, stages};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::{Table as Keys, Value};

/// Compare fits on shapes of elements, at large deformation and on scenes, with processor times and statistics
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    /// Shipped elements' names or element files; a scene; or a file with a table [compare]
    #[arg(required = true, value_name = "WHAT")]
    what: Vec<String>,
    #[command(flatten)]
    settings: Settings,
    /// A fit to compare, as the keys of a [[fit]] in TOML; a key may have a list of values, and each combination is a fit. May be repeated
    /// [default: all objectives]
    #[arg(long, value_name = "KEYS")]
    fit: Vec<String>,
    /// Shapes of an element [default: 100]
    #[arg(long, help_heading = "Element")]
    shapes: Option<usize>,
    /// How shapes are drawn: random, distorted [default: random]
    #[arg(long, value_delimiter = ',', help_heading = "Element")]
    family: Vec<String>,
    /// How far nodes are moved, in units of the reference cell [default: 0.15]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, help_heading = "Element")]
    distortion: Vec<f64>,
    /// Shapes are stretched along x by this factor [default: 1]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, help_heading = "Element")]
    aspect: Vec<f64>,
    /// Seeds of the shapes [default: 2010]
    #[arg(long, value_delimiter = ',', help_heading = "Element")]
    seed: Vec<u64>,
    /// Iterations of the general optimisers [default: 2000]
    #[arg(long, help_heading = "Element")]
    iterations: Option<u64>,
    /// Poisson's ratios, for elements [default: 0.3]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, help_heading = "Element")]
    poisson: Vec<f64>,
    /// An element at large deformation: the energies, shipped names such as neo-hookean, or files
    #[arg(long, value_delimiter = ',', help_heading = "Element")]
    law: Vec<String>,
    /// With --law, the largest stretch that is sampled [default: 0.35]
    #[arg(long, allow_hyphen_values = true, help_heading = "Element")]
    stretch: Option<f64>,
    /// Plane element: stress or strain [default: stress]
    #[arg(long, help_heading = "Element")]
    plane: Option<State>,
    /// Print what would be done, and stop: the cases, or of a scene its stages with estimates of time and memory
    #[arg(long)]
    explain: bool,
    /// Cases that run at the same time; the processors are shared out among them, and times are longer
    #[arg(long, default_value_t = 1, value_name = "N")]
    jobs: usize,
    /// Of a file with [compare]: go on from the cases that the folder has
    #[arg(long)]
    resume: bool,
    /// Folder of the tables and figures [default: out/compare-NAME]
    #[arg(long, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit compare tet4
  springfit compare tri3 quad4 tet4 hex8 --poisson 0,0.2,0.4,0.45
  springfit compare hex8 --fit \"objective = ['frobenius', 'spectral'], nonnegative = [false, true]\"
  springfit compare tri3 --law neo-hookean --plane strain
  springfit compare scene.toml --explain                 # the fits of a scene and their expected times
  springfit compare scene.toml --json                    # of a scene: the keys of report.json
  springfit compare norms.toml --jobs 2 --resume         # a file with [compare]: springfit schema compare --markdown
  springfit plot out/compare-tet4 --figure ecdf -o ecdf.svg";

impl Compare {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        study::check_jobs(self.jobs)?;
        let first = Path::new(&self.what[0]);
        let stem = first.file_stem().unwrap_or_default().to_string_lossy();
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(format!("compare-{stem}")));
        let text = std::fs::read_to_string(first).unwrap_or_default();
        if is_comparison(&text) {
            self.check_alone("a file with [compare], which has its own keys")?;
            self.settings.expect_none("a file with [compare]")?;
            let comparing = Comparing::load(first)?;
            return self.compare(terminal, &comparing, &folder, true);
        }
        self.check_options(is_scene(first))?;
        if is_scene(first) {
            self.check_alone("a scene, which names its material")?;
            return if self.fit.is_empty() {
                self.scene(terminal, first, &folder)
            } else {
                self.compare(terminal, &self.comparing("scenes")?, &folder, false)
            };
        }
        self.settings.expect_none("an element")?;
        match (&self.law[..], &self.what[..], &self.fit[..]) {
            ([law], [element], []) if self.poisson.len() < 2 && !self.explain => {
                self.stretches(terminal, element, law, &folder)
            }
            _ => self.compare(terminal, &self.comparing("elements")?, &folder, false),
        }
    }

    /// The comparison that the options ask for.
    fn comparing(&self, of: &str) -> Result<Comparing> {
        let list = |values: &[String]| Value::from(values.to_vec());
        let mut keys = Keys::new();
        keys.insert(of.into(), list(&self.what));
        let mut shapes = Keys::new();
        let whole = |number: u64| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
        shapes.extend(self.shapes.map(|count| ("count".to_string(), whole(count as u64))));
        if !self.seed.is_empty() {
            shapes.insert("seed".into(), Value::Array(self.seed.iter().map(|seed| whole(*seed)).collect()));
        }
        if !self.family.is_empty() {
            shapes.insert("family".into(), list(&self.family));
        }
        for (key, values) in [("distortion", &self.distortion), ("aspect", &self.aspect)] {
            if !values.is_empty() {
                shapes.insert(key.into(), Value::from(values.clone()));
            }
        }
        if !shapes.is_empty() {
            keys.insert("shapes".into(), Value::Table(shapes));
        }
        if !self.poisson.is_empty() {
            keys.insert("poisson".into(), Value::from(self.poisson.clone()));
        }
        if !self.law.is_empty() {
            keys.insert("laws".into(), list(&self.law));
        }
        keys.extend(self.stretch.map(|stretch| ("stretch".to_string(), Value::Float(stretch))));
        keys.extend(self.iterations.map(|iterations| ("iterations".to_string(), whole(iterations))));
        let plane = |plane: State| plane.to_possible_value().map_or(String::new(), |value| value.get_name().into());
        keys.extend(self.plane.map(|state| ("plane".to_string(), Value::String(plane(state)))));
        let fit = |text: &String| {
            // The keys stand between the braces of a table, so that commas divide them.
            let table: std::result::Result<Keys, _> = format!("keys = {{ {text} }}").parse();
            let keys = table.ok().and_then(|table| table.get("keys").cloned());
            let expected = "keys such as objective = 'spectral', nonnegative = [false, true]";
            keys.ok_or_else(|| Error::expected("--fit", expected, format!("\"{text}\"")))
        };
        let fits: Vec<Value> = self.fit.iter().map(fit).collect::<Result<_>>()?;
        if !fits.is_empty() {
            keys.insert("fit".into(), Value::Array(fits));
        }
        Comparing::of_table(keys, Path::new(""), &self.settings.read()?).map_err(|e| e.placed(option))
    }

    /// Runs the cases that are left, and writes what was found. A comparison in a file keeps each case when it is done.
    fn compare(&self, terminal: &mut Terminal, comparing: &Comparing, folder: &Path, is_file: bool) -> Result<()> {
        let cases = comparing.cases();
        let title = comparing.title().map_or_else(|| self.what.join(", "), String::from);
        if self.explain {
            let words: Vec<String> = cases.iter().map(study::ComparedCase::words).collect();
            let fits = comparing.fit_names();
            let text = || {
                let fits = if fits.is_empty() { "all objectives".into() } else { fits.join("\n  ") };
                format!("{title}: {}\n  {}\nfits\n  {fits}\n", cases_in_words(words.len()), words.join("\n  "))
            };
            return self.output.print_plan(terminal, &words, text);
        }
        let mut inputs = comparing.inputs();
        inputs.extend(is_file.then(|| PathBuf::from(&self.what[0])));
        let mut names = COMPARE_FILES.to_vec();
        names.extend((!is_file).then_some(CASES));
        let edition = report::open_outputs(folder, &names, &inputs)?;
        let mut lines = match is_file {
            true => Some(StudyLines::of_comparison(folder.join(CASES), self.resume, comparing, folder)?),
            false => None,
        };
        let known = |case: &study::ComparedCase| lines.as_ref().and_then(|lines| lines.of(&case.settings).cloned());
        let mut records: Vec<Option<CaseRecord>> = cases.iter().map(known).collect();
        let places: Vec<usize> = (0..cases.len()).filter(|place| records[*place].is_none()).collect();
        let mut done = cases.len() - places.len();
        if done > 0 {
            terminal.note(&format!("{done} of {} are there already", cases_in_words(cases.len())));
        }
        let mut keep = |place: usize, record: CaseRecord| -> Result<()> {
            if let Some(lines) = &mut lines {
                lines.push(record.clone())?;
            }
            records[place] = Some(record);
            Ok(())
        };
        if self.jobs == 1 {
            for place in places {
                let words = cases[place].words();
                let record = comparing.record(&cases[place], &mut |event| match event {
                    Event::Stage { name, done, total } => {
                        terminal.show(Event::stage(&format!("{words}: {name}"), done, total));
                    }
                    Event::Note(note) => terminal.show(Event::Note(note)),
                });
                keep(place, record)?;
            }
        } else {
            comparing.run(&places, self.jobs, |place, record| {
                done += 1;
                terminal.show(Event::stage("cases", done, cases.len()));
                keep(place, record)
            })?;
        }
        let records: Vec<CaseRecord> = records.into_iter().flatten().collect();
        if let [CaseRecord { error: Some(error), .. }] = &records[..] {
            return Err(Error::new(error.clone()));
        }
        let has_none = |method: &MethodRecord| method.refused.is_some() && method.values.is_empty();
        if let Some(first) = records.iter().flat_map(|record| &record.methods).next()
            && records.iter().all(|record| record.error.is_none() && record.methods.iter().all(has_none))
        {
            let why = first.refused.as_deref().unwrap_or_default();
            return Err(Error::new(format!("no fit has figures on any case: {}: {why}", first.fit)));
        }
        let summary = report::summarized(&title, &records);
        let paths = report::write_comparison(&summary, &records, edition, !is_file);
        let text = || report::compare_text(&summary);
        self.output.print(terminal, || &summary, || report::compare_tables(&summary), text)?;
        let failed = records.iter().filter(|record| record.error.is_some()).count();
        if failed > 0 {
            terminal.note(&format!("{failed} of {} failed; the tables say why", cases_in_words(records.len())));
        }
        let refused =
            records.iter().flat_map(|record| &record.methods).filter(|method| method.refused.is_some()).count();
        if refused > 0 {
            terminal.note(&format!(
                "{refused} of the figures of fits on cases are missing; the column \"why not\" of comparison.csv says why"
            ));
        }
        // The folder has many files: those that one opens first.
        let paths = paths?;
        let is_first = |path: &&PathBuf| {
            let name = path.file_name().unwrap_or_default();
            ["compare.html", "comparison.csv", "pairs.csv", "values.csv", "precision.svg"]
                .iter()
                .any(|own| name == *own)
        };
        let first: Vec<PathBuf> = paths.iter().filter(is_first).cloned().collect();
        terminal.written(&first)?;
        terminal.note(&format!("{} more files are in {}", paths.len() - first.len(), folder.display()));
        Ok(())
    }

    /// The fits of a scene beside each other.
    fn scene(&self, terminal: &mut Terminal, path: &Path, folder: &Path) -> Result<()> {
        let scene = self.settings.scene(path)?;
        if self.explain {
            let scene = study::compared(&scene)?;
            let forecast = Forecast::of(&scene)?;
            let text = || report::forecast_text(scene.title(), &forecast, &stages(&scene));
            return self.output.print_plan(terminal, &forecast, text);
        }
        let mut progress = |event: Event| terminal.show(event);
        let edition = report::open_outputs(folder, &report::COMPARISON_FILES, &scene.inputs())?;
        let outcome = study::compare_scene(&scene, &mut progress)?;
        outcome.assumed.iter().for_each(|assumed| progress(Event::Note(assumed)));
        self.print(terminal, &Comparison::of_scene(&outcome), || report::Report::of(&outcome), edition)
    }

    /// An element at large deformation, by more and more stretch and by more and more sampled shapes.
    fn stretches(&self, terminal: &mut Terminal, element: &str, law: &str, folder: &Path) -> Result<()> {
        let inputs = [PathBuf::from(element), PathBuf::from(law)];
        let edition = report::open_outputs(folder, &report::STRETCHES_FILES, &inputs)?;
        let element = Arc::new(Element::load(element)?);
        let poisson = self.poisson.first().copied().unwrap_or(0.3);
        let plane = self.plane.map(Into::into);
        let material = Material::for_body(element.dimension(), 10e3, poisson, plane, None).map_err(Error::of_option)?;
        let stretch = self.stretch.unwrap_or(0.35);
        let study =
            study::compare_stretches(&element, material, law, stretch, &mut |event: Event| terminal.show(event));
        let law = |e: Error| if e.key() == Some("energy") { e.at_key("--law") } else { e.of_option() };
        let study = study.map_err(|e| e.placed(law))?;
        let paths = report::write_stretches(&study, edition);
        let tables = report::stretches_tables(&study);
        let text = tables.each_ref().map(Table::titled_text).join("\n");
        self.output.print(terminal, || &study, || tables.to_vec(), || text)?;
        terminal.written(&paths?)
    }

    /// The options of elements that are given, and whether each is.
    fn of_elements(&self) -> [(&'static str, bool); 10] {
        [
            ("--law", !self.law.is_empty()),
            ("--poisson", !self.poisson.is_empty()),
            ("--plane", self.plane.is_some()),
            ("--shapes", self.shapes.is_some()),
            ("--family", !self.family.is_empty()),
            ("--distortion", !self.distortion.is_empty()),
            ("--aspect", !self.aspect.is_empty()),
            ("--seed", !self.seed.is_empty()),
            ("--iterations", self.iterations.is_some()),
            ("--stretch", self.stretch.is_some()),
        ]
    }

    /// That a file that says all itself stands alone, without options of elements.
    fn check_alone(&self, found: &str) -> Result<()> {
        if let [_, second, ..] = &self.what[..] {
            return Err(Error::new(format!(
                "expected one file or several elements, found \"{second}\" beside {found}"
            )));
        }
        let given = self.of_elements().into_iter().find(|(_, given)| *given);
        match given {
            Some((option, _)) => Err(Error::at(option, format!("belongs to an element, found {found}"))),
            None if !self.fit.is_empty() && found.contains("[compare]") => {
                Err(Error::at("--fit", format!("belongs to elements and scenes, found {found}")))
            }
            None => Ok(()),
        }
    }

    /// That each option belongs to what is compared.
    fn check_options(&self, is_scene: bool) -> Result<()> {
        let of_element = self.of_elements();
        let given = |options: &[(&'static str, bool)]| options.iter().find(|(_, given)| *given).map(|(name, _)| *name);
        let wrong = match (is_scene, self.law.is_empty()) {
            (true, _) => {
                given(&of_element).map(|option| (option, "an element, found a scene, which names its material"))
            }
            (false, false) => given(&of_element[3..9]).map(|option| (option, "a comparison without --law")),
            (false, true) => given(&of_element[9..]).map(|option| (option, "a comparison with --law")),
        };
        match wrong {
            Some((option, owner)) => Err(Error::at(option, format!("belongs to {owner}"))),
            None if self.resume => Err(Error::at("--resume", "belongs to a file with [compare]")),
            None => Ok(()),
        }
    }

    /// Writes the files of a comparison, and prints it.
    fn print<R: Serialize>(
        &self,
        terminal: &mut Terminal,
        comparison: &Comparison,
        record: impl FnOnce() -> R,
        edition: Edition,
    ) -> Result<()> {
        let paths = comparison.write(edition);
        self.output.print(terminal, record, || vec![comparison.table.clone()], || comparison.text())?;
        terminal.written(&paths?)
    }
}

fn cases_in_words(count: usize) -> String {
    if count == 1 { "1 case".into() } else { format!("{count} cases") }
}

/// A key of `[compare]` as the option that stands for it.
fn option(error: Error) -> Error {
    let key = error.key().map(String::from).unwrap_or_default();
    let (list, rest) = key.split_once(['[', '.']).unwrap_or((&key, ""));
    match list {
        "elements" => error.at_key("element"),
        "scenes" => error.at_key("scene"),
        "shapes" if rest == "count" || rest.is_empty() => error.at_key("--shapes"),
        "shapes" => error.at_key(format!("--{rest}")),
        "laws" => error.at_key("--law"),
        "fit" => error.at_key(format!("--{key}")),
        "" => error,
        _ => error.of_option(),
    }
}
