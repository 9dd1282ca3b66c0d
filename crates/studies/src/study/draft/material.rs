//! The material of a first scene: what is given, what a deck states, or a default.

use crate::mesh::{Mesh, Section};
use crate::quantity::Quantity;
use crate::text::{not_a_line, rounded, toml as quoted};

/// Poisson's ratio of a draft without one.
pub(super) const POISSON: f64 = 0.3;
/// The modulus of a draft without one, Pa.
const YOUNG: f64 = 10e3;
/// The largest number of labels of which each gets a material of its own.
// A draft is read and changed by hand, and tables of more materials than fit on a screen are not.
const MOST_REGIONS: usize = 12;

/// The material of a first scene, as values of TOML. A value that is `None` is replaced by a default.
#[derive(Debug, Clone, Default)]
pub struct DraftMaterial {
    /// Young's modulus, with or without a unit.
    pub young: Option<String>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// The density, with or without a unit.
    pub density: Option<String>,
}

/// A part of the body with a material of its own.
struct Region<'a> {
    /// The name of its group; `None` for the whole body, or for the rest.
    group: Option<&'a str>,
    /// What the deck states of it.
    section: Option<&'a Section>,
}

/// Poisson's ratio that the deck states, the largest of all parts.
pub(super) fn stated_poisson(mesh: &Mesh) -> Option<f64> {
    let stated = mesh.annotations.sections.iter().filter(|section| stands(section)).filter_map(|s| s.poisson);
    stated.reduce(f64::max)
}

/// Young's modulus in Pa, of a part whose material the deck states, if none is given.
pub(super) fn young(mesh: &Mesh, given: &DraftMaterial, scale: f64) -> f64 {
    let given = given.young.as_deref().and_then(|text| Quantity::Pressure.parse(text).ok());
    let stated = mesh.annotations.sections.iter().find(|section| stands(section)).and_then(|section| section.young);
    // The deck's stress is in newtons per square of the mesh unit, which is `scale` metres.
    given.or(stated.map(|young| young / (scale * scale))).unwrap_or(YOUNG)
}

/// Whether the deck states an elastic material.
fn stands(section: &Section) -> bool {
    let is_young = section.young.is_some_and(|young| young > 0.0 && young.is_finite());
    is_young && section.poisson.is_some_and(|poisson| poisson > -1.0 && poisson < 0.5)
}

/// The lines of `[material]`, or of a `[[material]]` for each part that has one of its own.
pub(super) fn material_lines(mesh: &Mesh, given: &DraftMaterial, scale: f64) -> Vec<String> {
    let regions = regions(mesh);
    let mut lines = Vec::new();
    for (i, region) in regions.iter().enumerate() {
        let is_first = i == 0;
        lines.push(if regions.len() == 1 { "[material]" } else { "[[material]]" }.to_string());
        match region.group {
            Some(name) if regions.len() > 1 => lines.push(format!("group   = {}", quoted(name))),
            None if regions.len() > 1 => lines.push("# the rest of the body".into()),
            _ => {}
        }
        lines.extend(constants(mesh, given, region.section, scale, is_first));
        if i + 1 < regions.len() {
            lines.push(String::new());
        }
    }
    if mesh.cell_dimension() == mesh.dimension {
        lines.push("# law = \"neo-hookean\"     # large deformation; `springfit materials` lists the energies".into());
    }
    let words = "# Regions: one [[material]] for each, with group = \"…\" or where = \"z < 0.01\", and one without for the rest.\n";
    lines.push(words.into());
    lines.extend(beside(mesh, scale));
    lines
}

/// What a deck states of cells of fewer dimensions than the body, which a material makes part of it: a line of comment for each.
fn beside(mesh: &Mesh, scale: f64) -> Vec<String> {
    let is_beside = |section: &&Section| {
        let group = mesh.groups.get(&section.group);
        group.is_some_and(|group| group.cells.is_empty()) && not_a_line(&section.group, false).is_none()
    };
    let stated = mesh.annotations.sections.iter().filter(|section| stands(section)).filter(is_beside);
    let line = |section: &Section| {
        let number = |key: &str, value: Option<f64>, factor: f64| {
            value.filter(|x| *x > 0.0).map(|x| format!(", {key} = {}", rounded(x * factor, 6))).unwrap_or_default()
        };
        format!(
            "# Not in the body until a [[material]] names it: group = {}{}{}{}{}",
            quoted(&section.group),
            number("young", section.young, scale.powi(-2)),
            number("poisson", section.poisson, 1.0),
            number("thickness", section.thickness, scale),
            number("area", section.area, scale * scale),
        )
    };
    let mut lines: Vec<String> = stated.take(MOST_REGIONS).map(line).collect();
    if !lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

/// The parts of the body: those of which a deck states the material, or labels of which each cell has one; or else the whole.
fn regions(mesh: &Mesh) -> Vec<Region<'_>> {
    let whole = || vec![Region { group: None, section: mesh.annotations.sections.iter().find(|s| stands(s)) }];
    let is_name = |name: &str| not_a_line(name, false).is_none();
    let cells_of = |name: &str| mesh.groups.get(name).map_or(0, |group| group.cells.len());
    let mut regions: Vec<Region> = Vec::new();
    for section in mesh.annotations.sections.iter().filter(|section| is_name(&section.group)) {
        let is_known = regions.iter().any(|region| region.group == Some(&section.group));
        if cells_of(&section.group) > 0 && !is_known {
            regions.push(Region { group: Some(&section.group), section: Some(section) });
        }
    }
    if regions.is_empty() {
        let labels = mesh.groups.iter().filter(|(name, group)| is_name(name) && !group.cells.is_empty());
        regions.extend(labels.map(|(name, _)| Region { group: Some(name), section: None }));
        // Labels may mark anything. Only labels that divide the body are taken for its materials.
        if covered(mesh, &regions) != Some(mesh.cell_count()) {
            return whole();
        }
    }
    let count = match covered(mesh, &regions) {
        Some(count) if regions.len() <= MOST_REGIONS && count > 0 => count,
        _ => return whole(),
    };
    if count < mesh.cell_count() {
        regions.push(Region { group: None, section: None });
    }
    regions
}

/// How many cells the regions have; `None` if two share one.
fn covered(mesh: &Mesh, regions: &[Region]) -> Option<usize> {
    let mut is_met: Vec<Vec<bool>> = mesh.blocks.iter().map(|block| vec![false; block.cells().len()]).collect();
    let mut count = 0;
    for name in regions.iter().filter_map(|region| region.group) {
        for cell in &mesh.groups.get(name)?.cells {
            if std::mem::replace(&mut is_met[cell.block][cell.cell], true) {
                return None;
            }
            count += 1;
        }
    }
    Some(count)
}

/// The constants of a part, as they are given, stated or by default; `explain` is whether words follow them.
fn constants(mesh: &Mesh, given: &DraftMaterial, section: Option<&Section>, scale: f64, explain: bool) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = |key: &str, value: String, words: &str| {
        let words = if explain { format!(" # {words}") } else { String::new() };
        lines.push(format!("{key:<7} = {value:<15}{words}").trim_end().to_string());
    };
    let value = |text: &str| if text.parse::<f64>().is_ok() { text.to_string() } else { quoted(text) };
    let stated = section.filter(|section| stands(section));
    let of_deck = |number: Option<f64>, factor: f64| number.filter(|x| *x > 0.0).map(|x| rounded(x * factor, 6));
    // Decks have consistent units: with newtons, those of the mesh.
    let origin = ", of the deck in N and mesh units";
    let young = given.young.as_deref().map(value);
    let from = |is_stated: bool| if is_stated { origin } else { "" };
    let (young, of_stated) = match (young, stated) {
        (Some(young), _) => (young, false),
        (None, Some(stated)) => (of_deck(stated.young, scale.powi(-2)).unwrap_or_default(), true),
        (None, None) => ("\"10 kPa\"".into(), false),
    };
    let words = "Young's modulus; or \"1e4*(1 + 20*z)\" with z in m, or { file = \"map.csv\" }";
    line("young", young, &format!("{words}{}", from(of_stated)));
    let poisson = given.poisson.or(stated.and_then(|stated| stated.poisson));
    line("poisson", rounded(poisson.unwrap_or(POISSON), 6), "Poisson's ratio, below 0.5");
    let longest = mesh.longest_side();
    match mesh.cell_dimension() {
        2 => {
            let thickness = of_deck(section.and_then(|section| section.thickness), scale);
            let is_stated = thickness.is_some();
            let thickness = thickness.unwrap_or_else(|| rounded(longest / 100.0, 1));
            line("thickness", thickness, &format!("m{}", from(is_stated)));
            line("plane", "\"stress\"".into(), "or \"strain\"");
        }
        1 => {
            let area = of_deck(section.and_then(|section| section.area), scale * scale);
            let is_stated = area.is_some();
            let area = area.unwrap_or_else(|| rounded(longest * longest / 1e4, 1));
            line("area", area, &format!("m^2, the cross-section{}", from(is_stated)));
        }
        _ => {}
    }
    // Every part has a density, or none.
    let all = mesh.annotations.sections.iter().all(|section| section.density.is_some_and(|density| density > 0.0));
    // A mass in the deck's units is N s² per mesh unit, and a density that mass by its cube: the fourth power of the
    // unit.
    let stated = section.filter(|_| all).and_then(|section| of_deck(section.density, scale.powi(-4)));
    let density = given.density.as_deref().map(value);
    let words = "kg/m^3; masses, [motion] and frequencies require it";
    match (density, stated) {
        (Some(density), _) => line("density", density, words),
        (None, Some(density)) => line("density", density, &format!("{words}{origin}")),
        (None, None) if explain => lines.push(format!("# density = 1000          # {words}")),
        (None, None) => {}
    }
    if explain && mesh.dimension == 3 && mesh.cell_dimension() == 2 {
        let words = "a surface resists no bending without it, and gives way to loads across it";
        lines.push(format!("# bending = \"plate\"       # {words}"));
    }
    if explain && mesh.dimension == 3 && mesh.cell_dimension() == 1 {
        let words = "lines turn freely where they meet without it, and are rods of a round section with it";
        lines.push(format!("# bending = \"rod\"         # {words}"));
    }
    lines
}
