//! The graph of source files: which file names what another one defines.

use super::module::Module;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The root of the modules of the program, which no path can name.
pub const PROGRAM: &str = "main.rs";

/// A source file of a package.
pub struct Source {
    /// Its folder in `crates`; empty for the package at the top.
    pub package: String,
    /// Within the package's `src`, with `/` between folders.
    pub path: String,
    pub text: String,
}

impl Source {
    pub fn new(package: &str, path: &str, text: &str) -> Source {
        Source { package: package.to_string(), path: path.to_string(), text: text.to_string() }
    }

    pub fn name(&self) -> String {
        if self.package.is_empty() { self.path.clone() } else { format!("{}/{}", self.package, self.path) }
    }
}

/// The crate's name and the names of the modules from there.
type Place = Vec<String>;

#[derive(Clone)]
enum Found {
    Module(Place),
    /// The file that defines an item.
    Item(usize),
}

pub struct Graph {
    modules: BTreeMap<Place, (usize, Module)>,
    /// By importing and imported file, one of the paths that lead there.
    pub imports: BTreeMap<(usize, usize), String>,
    /// By file, the first name of its place: the crate's name, or [`PROGRAM`].
    pub crates: BTreeMap<usize, String>,
}

impl Graph {
    pub fn of(sources: &[Source]) -> Graph {
        let mut graph = Graph { modules: BTreeMap::new(), imports: BTreeMap::new(), crates: BTreeMap::new() };
        for (file, source) in sources.iter().enumerate() {
            let root = match (source.path.as_str(), source.package.as_str()) {
                ("main.rs", _) => PROGRAM.to_string(),
                ("lib.rs", "") => "springfit".to_string(),
                ("lib.rs", package) => format!("springfit_{package}"),
                (_, _) => continue,
            };
            graph.add(sources, file, vec![root], Module::parse(&source.text));
        }
        let places: Vec<Place> = graph.modules.keys().cloned().collect();
        places.iter().for_each(|place| graph.connect(place));
        graph
    }

    /// Adds a module, and those that it declares.
    fn add(&mut self, sources: &[Source], file: usize, place: Place, mut module: Module) {
        self.crates.insert(file, place[0].clone());
        let Source { package, path, .. } = &sources[file];
        let (folder, name) = path.rsplit_once('/').map_or(("", path.as_str()), |(folder, name)| (folder, name));
        let folder = match name {
            "mod.rs" | "lib.rs" | "main.rs" => folder.to_string(),
            _ => path.trim_end_matches(".rs").to_string(),
        };
        for child in &module.declared {
            let stem = if folder.is_empty() { child.clone() } else { format!("{folder}/{child}") };
            let own = |path: String| sources.iter().position(|s| s.package == *package && s.path == path);
            let found = own(format!("{stem}.rs")).or_else(|| own(format!("{stem}/mod.rs")));
            let found = found.unwrap_or_else(|| panic!("{path} declares {child}, which is in no file"));
            let place = place.iter().chain([child]).cloned().collect();
            self.add(sources, found, place, Module::parse(&sources[found].text));
        }
        for (child, inline) in std::mem::take(&mut module.inline) {
            self.add(sources, file, [&place[..], &[child]].concat(), inline);
        }
        self.modules.insert(place, (file, module));
    }

    /// Enters what one module imports and names. What it passes on counts where it names it as well.
    fn connect(&mut self, place: &Place) {
        let (file, module) = &self.modules[place];
        let taken = module.imports.iter().filter(|i| !i.public || module.words.contains(&i.name)).map(|i| &i.path);
        let mut found = Vec::new();
        for path in taken.chain(&module.paths) {
            for target in self.resolve(place, path, &mut BTreeSet::new()).unwrap_or_default() {
                if let Found::Item(target) = target {
                    found.push((target, path.join("::")));
                }
            }
        }
        for (path, _) in module.globs.iter().filter(|(_, public)| !public) {
            for target in self.resolve(place, path, &mut BTreeSet::new()).unwrap_or_default() {
                let target = match target {
                    Found::Module(place) => self.modules[&place].0,
                    Found::Item(file) => file,
                };
                found.push((target, format!("{}::*", path.join("::"))));
            }
        }
        let file = *file;
        for (target, path) in found.into_iter().filter(|(target, _)| *target != file) {
            self.imports.entry((file, target)).or_insert(path);
        }
    }

    /// What a path means in a module; `None` where it leads out of the sources.
    fn resolve(&self, place: &Place, path: &[String], seen: &mut BTreeSet<(Place, String)>) -> Option<Vec<Found>> {
        let first = path[0].as_str();
        let mut found = match first {
            "crate" => vec![Found::Module(place[..1].to_vec())],
            "self" => vec![Found::Module(place.clone())],
            "super" => vec![Found::Module(place[..place.len() - 1].to_vec())],
            name if self.modules.contains_key(&vec![name.to_string()]) => vec![Found::Module(vec![name.to_string()])],
            _ => self.member(place, first, seen)?,
        };
        for name in &path[1..] {
            let mut next = Vec::new();
            for step in found {
                match step {
                    Found::Module(at) if name == "super" => next.push(Found::Module(at[..at.len() - 1].to_vec())),
                    Found::Module(at) => match self.member(&at, name, seen) {
                        Some(members) => next.extend(members),
                        // A macro's work, as it seems.
                        None => next.push(Found::Item(self.modules[&at].0)),
                    },
                    Found::Item(file) => next.push(Found::Item(file)),
                }
            }
            found = next;
        }
        Some(found)
    }

    /// What a name means within a module: a module and an item may share it. `None` where it means nothing.
    fn member(&self, place: &Place, name: &str, seen: &mut BTreeSet<(Place, String)>) -> Option<Vec<Found>> {
        if !seen.insert((place.clone(), name.to_string())) {
            return None;
        }
        let (file, module) = self.modules.get(place)?;
        let child: Place = place.iter().cloned().chain([name.to_string()]).collect();
        let mut found = None;
        if self.modules.contains_key(&child) {
            found.get_or_insert_with(Vec::new).push(Found::Module(child));
        }
        if module.defined.contains(name) {
            found.get_or_insert_with(Vec::new).push(Found::Item(*file));
        }
        for import in module.imports.iter().filter(|import| import.name == name) {
            found.get_or_insert_with(Vec::new).extend(self.resolve(place, &import.path, seen).unwrap_or_default());
        }
        if found.is_none() {
            for (path, _) in &module.globs {
                for target in self.resolve(place, path, seen).unwrap_or_default() {
                    if let Found::Module(target) = target {
                        found = found.or_else(|| self.member(&target, name, seen));
                    }
                }
            }
        }
        found
    }

    /// The sets of files of which each imports each other one, on the way by others of the set.
    pub fn circles(&self) -> Vec<BTreeSet<usize>> {
        let mut circles: Vec<BTreeSet<usize>> = Vec::new();
        let reached: BTreeMap<usize, BTreeSet<usize>> = self.crates.keys().map(|&f| (f, self.reached(f))).collect();
        for (&file, from) in &reached {
            if from.contains(&file) && !circles.iter().any(|circle| circle.contains(&file)) {
                circles.push(from.iter().copied().filter(|other| reached[other].contains(&file)).collect());
            }
        }
        circles
    }

    fn reached(&self, file: usize) -> BTreeSet<usize> {
        self.steps_from(file).into_keys().collect()
    }

    /// For each file that `file` imports, by way of others or not, the file that imports it on a shortest way.
    fn steps_from(&self, file: usize) -> BTreeMap<usize, usize> {
        let (mut steps, mut open) = (BTreeMap::new(), VecDeque::from([file]));
        while let Some(file) = open.pop_front() {
            for (_, next) in self.imports.range((file, 0)..=(file, usize::MAX)).map(|(edge, _)| *edge) {
                if let Entry::Vacant(step) = steps.entry(next) {
                    step.insert(file);
                    open.push_back(next);
                }
            }
        }
        steps
    }

    /// A shortest way from a file back to itself, as the imports along it, the last one first.
    pub fn way_back(&self, file: usize) -> Vec<(usize, usize)> {
        let steps = self.steps_from(file);
        let (mut way, mut at) = (vec![(steps[&file], file)], steps[&file]);
        while at != file {
            way.push((steps[&at], at));
            at = steps[&at];
        }
        way
    }
}
