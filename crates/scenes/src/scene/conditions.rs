//! What of a scene names parts of the mesh, and places on it.

use super::document::Scene;
use super::load::LoadCase;
use super::material::MaterialEntry;
use super::part::Part;
use crate::fits::held_conditions;
use crate::mesh::{Mesh, Selection};
use crate::model::{Action, Component};

impl Scene {
    /// Chooses on a mesh what the conditions of the scene select, for the meshes into which its cells are divided. Conditions that are wrong
    /// in this dimension are left to the places where they are asked.
    pub fn choose(&self, mesh: &mut Mesh) {
        let loaded = self.loads.iter().filter_map(|load| {
            let (part, action) = load.single()?;
            // A pressure on a surface in space acts on cells.
            Some((part.clone(), matches!(action, Action::Body(_) | Action::Pressure(_))))
        });
        let held = self.supports.iter().map(|hold| (hold.part.clone(), false));
        let of_material = self.material_parts().into_iter().map(|(_, part)| (part, true));
        let d = mesh.dimension;
        let of_fits = held_conditions(mesh, self.fits.iter().filter_map(|fit| fit.recipe.whole()));
        let conditions =
            held.chain(loaded).chain(of_material).filter_map(|(part, asks_cells)| match part.selection(d) {
                Ok(Selection::Where(condition)) => Some((condition, asks_cells)),
                Ok(Selection::Group(_) | Selection::Everything) | Err(_) => None,
            });
        mesh.choose(conditions.chain(of_fits.into_iter().map(|condition| (condition, false))));
    }

    /// Whether anything besides the mesh is given in metres: conditions, and loads that vary.
    pub fn is_in_metres(&self) -> bool {
        let actions = || self.loads.iter().filter_map(LoadCase::single);
        let conditions = self.supports.iter().map(|hold| &hold.part).chain(actions().map(|(part, _)| part));
        let varies = |action: &Action| match action {
            Action::Traction(v) | Action::Body(v) => v.iter().any(|c| matches!(c, Component::Varying(_))),
            Action::Displacement(v) => v.iter().any(|c| matches!(c, Some(Component::Varying(_)))),
            Action::Pressure(component) => matches!(component, Component::Varying(_)),
            Action::Force(_) | Action::Volume(_) | Action::Moment(_) => false,
        };
        let of_place = |entry: &MaterialEntry| {
            entry.condition.is_some() || entry.axes.is_some() || entry.fibre.is_some() || entry.varies()
        };
        self.material.all.iter().any(of_place)
            || conditions.into_iter().any(|part| matches!(part, Part::Where(_)))
            || actions().any(|(_, action)| varies(action))
            || self.loads.iter().any(|load| load.measured.is_some())
    }

    /// The parts of the body with materials of their own, by their places in the scene.
    pub(crate) fn material_parts(&self) -> Vec<(String, Part)> {
        let all = self.material.all.iter().enumerate();
        all.filter_map(|(i, entry)| Some((self.material.key(i), entry.part().ok()?))).collect()
    }
}
