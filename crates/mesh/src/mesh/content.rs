//! What a file is by its content, whatever its ending says.

use super::formats::{MESH_FORMATS, MeshFormat};

/// The bytes in which a file says what it is.
pub(super) const BEGINNING: usize = 1 << 16;

/// What a file is.
pub(super) enum Content {
    /// One of the formats that are read.
    Known(&'static MeshFormat),
    /// Another, by its name, and what makes one of it that is read.
    Other(&'static str, &'static str),
}

/// Formats that are not read, by a line with which they begin or a mark near their beginning.
const OTHERS: [(&str, &str, &str); 10] = [
    ("<mujoco", "a model of MuJoCo", "name the mesh file of one of its flexes or meshes"),
    ("mesh dimension", "a mesh of GiD", "GiD's export to Abaqus or Nastran"),
    ("*keyword", "a deck of LS-DYNA", "LS-PrePost's export to Abaqus or Nastran"),
    ("(0 ", "a mesh of Fluent", "meshio convert --input-format ansys FILE mesh.vtu"),
    ("(1 ", "a mesh of Fluent", "meshio convert --input-format ansys FILE mesh.vtu"),
    ("(2 ", "a mesh of Fluent", "meshio convert --input-format ansys FILE mesh.vtu"),
    ("mesh3d", "a mesh of Netgen", "meshio convert --input-format netgen FILE mesh.vtu"),
    ("ndime=", "a mesh of SU2", "meshio convert --input-format su2 FILE mesh.vtu"),
    ("meshversionformatted", "a mesh of Medit", "meshio convert --input-format medit FILE mesh.vtu"),
    ("femesh", "a mesh of SfePy or FEMesh", "meshio convert FILE mesh.vtu"),
];

/// What a file is whose content begins with these bytes; `None` if they do not say.
pub(super) fn content(bytes: &[u8]) -> Option<Content> {
    let bytes = &bytes[..bytes.len().min(BEGINNING)];
    // Editors of Windows begin a text with this mark.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let known = |name: &str| MESH_FORMATS.iter().find(|format| format.name == name).map(Content::Known);
    if bytes.starts_with(b"\x93NUMPY") {
        return known("NumPy, labels of voxels");
    }
    // The beginning may end inside a character.
    let text = String::from_utf8_lossy(bytes).to_lowercase();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.clone().next()?;
    let has = |mark: &str| text.lines().any(|line| line.trim_start().starts_with(mark));
    if first.starts_with("# vtk datafile") {
        return known("legacy VTK");
    }
    if first.starts_with('<') && text.contains("<vtkfile") {
        return if lists_files(&text) {
            Some(Content::Other("a list of files of VTK", LISTED))
        } else {
            known("VTK XML")
        };
    }
    if first == "ply" {
        return known("PLY");
    }
    // The counts may stand in the same line.
    if ["off", "coff", "noff", "stoff", "cnoff"].contains(&first.split_whitespace().next()?) {
        return known("OFF");
    }
    if ["$meshformat", "$nod", "$comments", "$physicalnames"].contains(&first) {
        return known("Gmsh");
    }
    // A line that begins with a parenthesis may stand in any file: it means Fluent only as the first.
    if let Some((_, name, way)) =
        OTHERS.iter().find(|(mark, ..)| first.starts_with(mark) || (!mark.starts_with('(') && has(mark)))
    {
        return Some(Content::Other(name, way));
    }
    // After the decks of LS-DYNA, whose keywords begin with a star too.
    if is_abaqus(&text) {
        return known("Abaqus and CalculiX");
    }
    if is_nastran(&text) {
        return known("Nastran");
    }
    // Files of other programs begin with this word too.
    if first.starts_with("solid") && text.contains("facet normal") {
        return known("STL");
    }
    if is_avs(lines.by_ref()) {
        let way = "meshio convert --input-format avsucd FILE mesh.vtu";
        return Some(Content::Other("a mesh of AVS (UCD)", way));
    }
    None
}

/// The way from a file that lists others.
const LISTED: &str = "none is needed: name one of the files that it lists";

/// Whether an XML file of VTK has no cells of its own, but names of files: collections, blocks, and parallel pieces.
fn lists_files(text: &str) -> bool {
    let kinds = ["collection", "vtkmultiblock", "vtkpartitioned", "vtkhierarchical", "vtkoverlapping"];
    let parallel = ["punstructuredgrid", "ppolydata", "pimagedata", "pstructuredgrid", "prectilineargrid"];
    let kind = text.split("<vtkfile").nth(1).and_then(|rest| rest.split('>').next()).unwrap_or_default();
    let kind = kind.split("type=").nth(1).map_or("", |value| value.trim_start_matches(['"', '\'']));
    kinds.iter().chain(&parallel).any(|name| kind.starts_with(name))
}

/// Keywords begin with a star, and comments with two.
fn is_abaqus(text: &str) -> bool {
    let mut keywords =
        text.lines().map(str::trim_start).filter(|line| line.starts_with('*') && !line.starts_with("**"));
    let words = ["*heading", "*node", "*part", "*include", "*element", "*preprint", "*nset", "*material", "*assembly"];
    keywords.any(|line| words.iter().any(|word| line.starts_with(word)))
}

/// Cards of grid points with elements, or the word that begins them.
fn is_nastran(text: &str) -> bool {
    let starts = |mark: &str| text.lines().any(|line| line.starts_with(mark));
    let begins = text.lines().any(|line| line.split_whitespace().take(2).eq(["begin", "bulk"]));
    let is_card =
        |name: &str, line: &str| line.strip_prefix(name).is_some_and(|rest| rest.starts_with([' ', ',', '*', '\t']));
    let has_grid = text.lines().any(|line| is_card("grid", line));
    begins
        || (has_grid
            && ["ctetra", "chexa", "cpenta", "cpyra", "ctria", "cquad", "cbar", "cbeam", "crod"]
                .iter()
                .any(|c| starts(c)))
}

/// A line of five counts, and as many lines of a number and three coordinates as the first says.
fn is_avs<'t>(lines: impl Iterator<Item = &'t str>) -> bool {
    let mut lines = lines.skip_while(|line| line.starts_with('#'));
    let counts = |line: &str| line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<u64>>>();
    let Some(counts) = lines.next().and_then(counts).filter(|counts| counts.len() == 5) else { return false };
    let is_point = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.len() == 4 && words[0].parse::<u64>().is_ok() && words[1..].iter().all(|word| word.parse::<f64>().is_ok())
    };
    counts[0] > 0 && lines.next().is_some_and(is_point)
}
