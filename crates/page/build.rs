//! Takes the text of Plotly from its package and compresses it.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // The first element is Plotly, the second typesets formulas.
    let elements = plotly::Plot::offline_js_sources();
    let text = elements.split_once('>').and_then(|(_, rest)| rest.split_once("</script>"));
    let library = text.map(|(library, _)| library).filter(|library| library.contains("plotly.js v"));
    let library = library.expect("the package plotly no longer begins with the library: adapt this build script");
    // Compressed once for each build, and carried by each page.
    let mut compressed = GzEncoder::new(Vec::new(), Compression::best());
    compressed.write_all(library.as_bytes()).expect("memory grows");
    let folder = std::env::var("OUT_DIR").expect("cargo sets it");
    let path = Path::new(&folder).join("plotly.js.gz");
    std::fs::write(&path, compressed.finish().expect("memory grows")).expect("cargo's folder can be written");
}
