//! `springfit groups`.

use super::mesh_file::MeshOptions;
use super::output::OutputOptions;
use super::scene_file::{Settings, is_scene};
use crate::terminal::Terminal;
use clap::Args;
use springfit_foundation::error::Result;
use springfit_mesh::mesh::listed_endings;
use springfit_report::report::NamedMesh;
use std::path::PathBuf;

/// List the groups of a mesh, with what they hold and where they are
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Groups {
    #[arg(help = format!("The mesh: {}; or a scene, whose mesh is read or generated", listed_endings()))]
    mesh: PathBuf,
    #[command(flatten)]
    options: MeshOptions,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  springfit groups organ.msh
  springfit groups organ.msh --scale mm   # a mesh in millimetres
  springfit groups scene.toml             # those of a box: xmin, xmax, ...

With --json: the keys mesh, points, elements, extent (m), groups with name, cells, sides, edges, points, from, to (m)";

impl Groups {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let (name, mesh) = if is_scene(&self.mesh) {
            self.options.expect_none()?;
            let scene = self.settings.scene(&self.mesh)?;
            (scene.title().to_string(), scene.build_mesh()?)
        } else {
            self.settings.expect_none("an element")?;
            let mesh = self.options.mesh(&self.mesh)?;
            self.options.unit_note(&mesh).iter().for_each(|words| terminal.note(words));
            (self.mesh.display().to_string(), mesh)
        };
        let named = NamedMesh { name, mesh };
        self.output.print(terminal, || &named, || vec![named.table()], || named.text())
    }
}
