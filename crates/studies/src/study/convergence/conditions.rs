//! What the conditions of a scene select on a mesh. Conditions that cut through cells select other parts on finer meshes.

use crate::mesh::{Mesh, Selection};
use crate::model::{Action, nodal_forces};
use crate::study::scene::{Part, Scene};

/// Contents that differ by less than this share are equal up to rounding.
pub(super) const ROUNDING: f64 = 1e-6;

/// What a condition selects on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Selected {
    /// The place of the condition in the scene.
    key: String,
    /// The area of the sides on the boundary, m²; in the plane their length, m.
    sides: f64,
    /// The volume of the cells, m³; in the plane their area, m².
    cells: f64,
    units: [&'static str; 2],
}

impl Selected {
    /// Finds what each condition of a scene selects on a mesh.
    pub fn all(scene: &Scene, mesh: &Mesh) -> Vec<Selected> {
        let d = mesh.dimension;
        let along_x: Vec<f64> = (0..d).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
        let content = |selection: &Selection, action: Action| -> f64 {
            nodal_forces(mesh, selection, &action, 1.0).map_or(0.0, |forces| forces.iter().step_by(d).sum())
        };
        let selected = |(key, part, of): (String, Part, Contents)| {
            let selection = part.selection(d).ok()?;
            let mut sides = content(&selection, Action::traction(&along_x));
            let mut cells = content(&selection, Action::body(&along_x));
            match of {
                Contents::Sides => cells = 0.0,
                Contents::Cells => sides = 0.0,
                // A force is shared over cells only if there are no sides.
                Contents::SidesOrCells => cells = if sides > 0.0 { 0.0 } else { cells },
                Contents::Both => {}
            }
            let units = [["m", "m²"], ["m²", "m³"]][usize::from(mesh.cell_dimension() == 3)];
            Some(Selected { key, sides, cells, units })
        };
        conditions(scene).into_iter().filter_map(selected).collect()
    }

    /// How it differs from what the same condition selects on the level before, in words.
    pub fn change(&self, before: &Selected) -> Option<String> {
        let differs = |a: f64, b: f64| (a - b).abs() > ROUNDING * a.abs().max(b.abs());
        let pairs = [("sides", self.sides, before.sides), ("cells", self.cells, before.cells)];
        let changed = pairs.iter().zip(self.units).find(|((_, now, then), _)| differs(*now, *then));
        changed.map(|((what, now, then), unit)| {
            format!(
                "the condition of {} selects {what} of {now:.4e} {unit}, on the level before {then:.4e} {unit}: it cuts through cells, \
                 and the levels are different problems. Conditions between the points of the coarsest mesh, and groups, select \
                 the same on all levels",
                self.key
            )
        })
    }
}

/// On what of a selection something acts.
enum Contents {
    Sides,
    Cells,
    SidesOrCells,
    Both,
}

/// The conditions of a scene, with their places in it.
fn conditions(scene: &Scene) -> Vec<(String, Part, Contents)> {
    let mut all = Vec::new();
    for (i, (part, _)) in scene.supports().iter().enumerate() {
        all.push((format!("fix[{i}]"), part.clone(), Contents::Both));
    }
    for (i, load) in scene.loads().iter().enumerate() {
        let Some((part, action)) = load.single() else { continue };
        let of = match action {
            Action::Traction(_) => Contents::Sides,
            Action::Body(_) => Contents::Cells,
            Action::Force(_) => Contents::SidesOrCells,
            Action::Displacement(_) => Contents::Both,
        };
        all.push((format!("load[{i}]"), part.clone(), of));
    }
    all.extend(scene.material_parts().into_iter().map(|(key, part)| (key, part, Contents::Cells)));
    all.retain(|(_, part, _)| matches!(part, Part::Where(_)));
    all
}
