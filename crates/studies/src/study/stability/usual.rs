//! The sweep of one element, or of the usual elements, bodies and motions.

use super::bodies::sweep_bodies;
use super::elements::sweep_element;
use super::motions::sweep_motions;
use super::outcome::StabilityOutcome;
use crate::element::{Element, SHIPPED};
use crate::error::Result;
use springfit_scenes::{Event, Progress};
use std::time::Instant;

/// The largest number of nodes of the elements that are swept by default; larger ones take a minute each.
const NODES: usize = 10;

/// Sweeps one element, or else the usual elements, bodies and motions.
///
/// # Errors
/// An element has no valid shape.
pub fn stability(element: Option<Element>, progress: &mut Progress) -> Result<StabilityOutcome> {
    let start = Instant::now();
    let everything = element.is_none();
    let elements = element.map_or_else(shipped, |own| Ok(vec![own]))?;
    let mut rows = Vec::new();
    for (done, element) in elements.iter().enumerate() {
        // Of several elements each is a step; of one element each of its shapes is.
        let steps = (elements.len() > 1).then_some((done, elements.len()));
        rows.extend(sweep_element(element, &mut |shapes, of| {
            let (done, total) = steps.unwrap_or((shapes, of));
            progress(Event::stage(&element.name, done, total));
        })?);
    }
    let mut title = elements.iter().map(|element| element.name.as_str()).collect::<Vec<_>>().join(", ");
    if everything {
        rows.extend(sweep_bodies(&elements)?);
        rows.extend(sweep_motions(&elements)?);
        title += ", bodies and motions";
    }
    Ok(StabilityOutcome { title, rows, seconds: start.elapsed().as_secs_f64() })
}

fn shipped() -> Result<Vec<Element>> {
    let all: Vec<Element> = SHIPPED.iter().map(Element::shipped).collect::<Result<_>>()?;
    Ok(all.into_iter().filter(|element| element.dimension() > 1 && element.nodes() <= NODES).collect())
}
