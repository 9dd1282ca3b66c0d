//! What a run writes for a scene whose names are hostile, read by the readers of Python.

use super::hostile::printable_lines;
use super::readers::parsed_by_python;
use crate::kit::prints;
use springfit_foundation::text::toml;
use std::fs;
use tempfile::TempDir;

/// Every file parses, and has the names: tables of CSV as cells that no spreadsheet evaluates, JSON and XML as texts, the page as one
/// script more than without.
const READ: &str = r#"
import csv, glob, html.parser, json, xml.etree.ElementTree as tree

names = json.load(open("names.json"))
evaluated = ("=", "+", "-", "@", "\t", "\r")

def is_number(cell):
    try:
        return all(word == "-" or float(word) is not None for word in cell.split())
    except ValueError:
        return False

def text(cell):
    return cell[1:] if cell[:1] == "'" else cell

tables = 0
for path in glob.glob("*/**/*.csv", recursive=True):
    rows = list(csv.reader(open(path, newline="")))
    tables += 1
    for cell in (cell for row in rows for cell in row):
        assert is_number(cell) or not cell.lstrip(" ").startswith(evaluated), (path, cell)
    if path.endswith("converge.csv"):
        assert {text(row[0]) for row in rows[1:]} == set(names), (path, {row[0] for row in rows[1:]} ^ set(names))
assert tables > 3, tables

for path in glob.glob("**/*.svg", recursive=True) + glob.glob("*/**/*.vtu", recursive=True) + glob.glob("*/**/*.pvd", recursive=True):
    tree.parse(path)
for path in glob.glob("o/mesh.vtu", recursive=True):
    arrays = {a.get("Name") for a in tree.parse(path).iter("DataArray")}
    assert {f"u fem {name} (m)" for name in names} <= arrays, arrays
for path in glob.glob("**/*.json", recursive=True):
    json.load(open(path))
report = json.load(open("o/report.json"))
assert [load["name"] for load in report["fits"][0]["loads"]] == names

class Page(html.parser.HTMLParser):
    scripts, title, inside = [], "", ""
    def handle_starttag(self, tag, attributes):
        self.inside = tag
        if tag == "script":
            self.scripts.append("")
    def handle_endtag(self, tag):
        self.inside = ""
    def handle_data(self, data):
        if self.inside == "script":
            self.scripts[-1] += data
        if self.inside == "title":
            self.title += data

for path in glob.glob("o/*.html"):
    page = Page()
    page.feed(open(path).read())
    assert len(page.scripts) == 3, len(page.scripts)
    assert names[0] in page.title or json.load(open("title.json")) in page.title, page.title
    record = [json.loads(script) for script in page.scripts if script.lstrip().startswith("{")]
    assert len(record) == 1
"#;

#[test]
fn every_file_of_a_run_has_each_name_once_as_a_text() {
    let folder = TempDir::new().unwrap();
    let names: Vec<String> = printable_lines().into_iter().filter(|name| !name.trim().is_empty()).collect();
    let title = names.join(" ");
    let mut scene = format!(
        "title = {}\n[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [2, 2] }}\n[material]\nyoung = 1000\n\
         poisson = 0.3\nthickness = 0.01\n[[fix]]\ngroup = \"xmin\"\n[output]\nvtu = true\ncsv = true\nreport = true\n",
        toml(&title)
    );
    for fit in ["=cmd|' /C calc'!A0", "</script><b> & \"'", "$x$ \\input{x} |"] {
        scene += &format!("[[fit]]\nname = {}\nobjective = \"offdiag\"\n", toml(fit));
    }
    for name in &names {
        scene += &format!("[[load]]\nname = {}\ngroup = \"xmax\"\ntraction = [1, 0]\n", toml(name));
    }
    fs::write(folder.path().join("s.toml"), scene).unwrap();
    fs::write(folder.path().join("names.json"), serde_json::to_string(&names).unwrap()).unwrap();
    fs::write(folder.path().join("title.json"), serde_json::to_string(&title).unwrap()).unwrap();
    prints(folder.path(), &["run", "s.toml", "--out", "o"]);
    prints(folder.path(), &["converge", "s.toml", "--levels", "2", "--out", "c"]);
    for figure in ["work-precision", "constants", "deformation", "moduli"] {
        let file = format!("{figure}.svg");
        prints(folder.path(), &["plot", "o", "--figure", figure, "-o", &file]);
    }
    // Names are found again in the table.
    prints(
        folder.path(),
        &["plot", "c", "--figure", "convergence", "--of", "=cmd|' /C calc'!A0", "-o", "convergence.svg"],
    );
    parsed_by_python(folder.path(), READ);
}
