//! The supports under which loads are made from the mesh: groups that are held, and conditions.

use super::recipe::WholeRecipe;
use crate::error::{Error, Result};
use crate::extent::extends;
use crate::mesh::{Mesh, Selection};
use crate::model::{Support, unheld_bodies};
use crate::named::unknown;
use crate::symbolic::{Predicate, Scope};

/// A support under which loads are made from the mesh.
pub(super) struct Held {
    /// The groups that are held, or conditions; empty for the `[[fix]]` of the scene.
    pub groups: Vec<String>,
    pub support: Support,
    /// The finer mesh, if there is one, has this support.
    pub fine: Option<Support>,
}

impl Held {
    /// The support in words.
    pub fn words(&self) -> String {
        if self.groups.is_empty() { "[[fix]]".into() } else { self.groups.join(", ") }
    }
}

/// What a text of a list of supports holds: the group with this name, or where there is none the points with this condition on x, y and z in m.
///
/// # Errors
/// It is neither.
fn held_part(mesh: &Mesh, text: &str) -> Result<Selection> {
    if mesh.groups.contains_key(text) {
        return Ok(Selection::Group(text.into()));
    }
    Scope::of_place(mesh.dimension).predicate(text).map(Selection::Where).map_err(|e| {
        if text.contains(['<', '>', '=']) {
            return e;
        }
        let known = mesh.groups.keys().map(String::as_str);
        let names = known.clone().collect::<Vec<_>>().join(", ");
        unknown(format!("groups of the mesh ({names}), or conditions such as \"x < 0.01\""), known, text)
    })
}

/// The conditions in the lists of supports of whole-object fits with these recipes; those that are wrong are left to the places where they are asked.
pub fn held_conditions<'a>(mesh: &Mesh, recipes: impl Iterator<Item = &'a WholeRecipe>) -> Vec<Predicate> {
    let parsed = recipes.flat_map(WholeRecipe::held).filter_map(|text| match held_part(mesh, text).ok()? {
        Selection::Where(condition) => Some(condition),
        Selection::Group(_) | Selection::Everything => None,
    });
    parsed.collect()
}

/// The support that holds these groups of points, and points with these conditions.
///
/// # Errors
/// There is no such group, a text is no condition, or a body is not held.
pub(super) fn held_by(mesh: &Mesh, parts: &[String]) -> Result<Support> {
    let mut support = Support::free(mesh);
    let directions: Vec<usize> = (0..mesh.dimension).collect();
    for text in parts {
        let points = held_part(mesh, text)?.points(mesh)?;
        if points.is_empty() {
            let found = format!("none with \"{text}\": the body extends {}", extends(mesh));
            return Err(Error::new(format!("expected points to hold, found {found}")));
        }
        support.fix(&points, &directions, mesh.dimension);
    }
    if support.prescribed.iter().all(Option::is_some) {
        return Err(Error::new("expected groups that leave points free to move, found all points held"));
    }
    if let Some(body) = unheld_bodies(mesh, &support).first() {
        let found = format!("{} rigid motions left to one of {} points", body.motions, body.points);
        return Err(Error::new(format!("expected groups that hold every body, found {found}")));
    }
    Ok(support)
}
