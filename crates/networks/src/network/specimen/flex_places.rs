//! Where the vertices of a flex are.

use crate::error::{Error, ErrorKind, Result};
use roxmltree::{Document, Node};

/// What turns or stretches what is below it.
const TURNS: [&str; 5] = ["quat", "euler", "axisangle", "xyaxes", "zaxis"];

/// A flex in its document.
pub struct Places<'a, 'input> {
    pub document: &'a Document<'input>,
    pub flex: Node<'a, 'input>,
}

impl Places<'_, '_> {
    /// The positions of the vertices in the axes of the world, `[vertices × 3]`, m.
    pub fn points(&self) -> Result<Vec<f64>> {
        let is_component = self.flex.tag_name().name() == "flexcomp";
        if is_component && self.flex.attribute("type").unwrap_or("grid") != "direct" {
            let found = format!("\"{}\"", self.flex.attribute("type").unwrap_or("grid"));
            let advice = "; the model that MuJoCo saves (mj_saveLastXML) has its vertices";
            let error = Error::expected("type", "\"direct\", with points and elements", found);
            return Err(error.followed_by(advice).of_kind(ErrorKind::Unsupported));
        }
        let listed = self.flex.attribute(if is_component { "point" } else { "vertex" }).unwrap_or_default();
        let mut points = numbers(if is_component { "point" } else { "vertex" }, listed)?;
        let bodies: Vec<&str> = self.flex.attribute("body").unwrap_or_default().split_whitespace().collect();
        if points.is_empty() {
            // A vertex that is not listed is where its body is.
            points = vec![0.0; 3 * bodies.len()];
        }
        if points.is_empty() || !points.len().is_multiple_of(3) {
            let found = format!("{} numbers", points.len());
            return Err(Error::expected("vertices", "three coordinates of each vertex", found));
        }
        if is_component {
            let scale = self.vector(self.flex, "scale")?.unwrap_or([1.0; 3]);
            let offset = self.offset(self.flex)?;
            for x in points.as_chunks_mut::<3>().0 {
                (0..3).for_each(|k| x[k] = x[k] * scale[k] + offset[k]);
            }
            return Ok(points);
        }
        let count = points.len() / 3;
        if bodies.len() > 1 && bodies.len() != count {
            return Err(Error::expected("body", format!("a body, or one for each of {count} vertices"), bodies.len()));
        }
        let offsets = bodies.iter().map(|name| self.place(name)).collect::<Result<Vec<[f64; 3]>>>()?;
        for (p, x) in points.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            // One body carries all vertices. Of several bodies each carries its own vertex.
            let Some(offset) = offsets.get(if offsets.len() == 1 { 0 } else { p }) else { continue };
            (0..3).for_each(|k| x[k] += offset[k]);
        }
        Ok(points)
    }

    /// Where the body of this name is.
    fn place(&self, name: &str) -> Result<[f64; 3]> {
        if name == "world" {
            return Ok([0.0; 3]);
        }
        let is_it = |node: &Node| node.tag_name().name() == "body" && node.attribute("name") == Some(name);
        let body = self.document.descendants().find(is_it);
        self.offset(body.ok_or_else(|| Error::expected("body", "the name of a body", format!("\"{name}\"")))?)
    }

    /// The sum of the positions of a node and of the bodies around it.
    fn offset(&self, node: Node) -> Result<[f64; 3]> {
        let mut sum = [0.0; 3];
        // Places are relative to the body around them. Without turns the places add up.
        for around in node.ancestors() {
            if let Some(turn) = TURNS.iter().find(|turn| around.has_attribute(**turn)) {
                let expected = "a flex and bodies around it that are not turned";
                return Err(Error::expected(*turn, expected, "one that is").of_kind(ErrorKind::Unsupported));
            }
            let own = self.vector(around, "pos")?.unwrap_or_default();
            (0..3).for_each(|k| sum[k] += own[k]);
        }
        Ok(sum)
    }

    fn vector(&self, node: Node, name: &str) -> Result<Option<[f64; 3]>> {
        let Some(text) = node.attribute(name) else { return Ok(None) };
        let values = numbers(name, text)?;
        let found = values.len();
        <[f64; 3]>::try_from(values).map(Some).map_err(|_| Error::expected(name, "three numbers", found))
    }
}

/// Numbers with spaces between them.
pub fn numbers(key: &str, text: &str) -> Result<Vec<f64>> {
    let number = |word: &str| {
        let number = word.parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| Error::expected(key, "numbers", format!("\"{word}\"")))
    };
    text.split_whitespace().map(number).collect()
}
