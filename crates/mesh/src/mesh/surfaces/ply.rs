//! PLY, text and binary in both byte orders.

use super::faces::{Faces, TRIANGULATE};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::lines::words;
use crate::mesh::reader::{Encoding, Number, Reader, quoted};
use crate::mesh::source::MeshSource;

/// Reads the `vertex` and `face` elements of a PLY file; other elements and properties are passed over.
///
/// # Errors
/// The file has faces of more than four corners that are not flat, or is damaged or cut short.
pub fn parse(bytes: &[u8]) -> Result<MeshSource> {
    let mut reader = Reader::new(bytes);
    let elements = header(&mut reader)?;
    let mut points = Vec::new();
    let mut faces = Faces::new();
    let is_there = |name: &str| elements.iter().any(|element| element.name == name);
    if !is_there("vertex") {
        return Err(reader.expected("an element vertex in the header", "none"));
    }
    for element in &elements {
        reader.enter(format!("element {}", element.name));
        reader.announce("of them", element.count);
        match element.name.as_str() {
            "vertex" => vertices(&mut reader, element, &mut points)?,
            "face" => polygons(&mut reader, element, &points, &mut faces)?,
            _ => {
                // Elements without properties have no bytes, and a header may count as many of them as it likes.
                if element.properties.is_empty() {
                    continue;
                }
                for _ in 0..element.count {
                    element.properties.iter().try_for_each(|property| property.skip(&mut reader))?;
                    reader.count_one();
                }
            }
        }
    }
    let rest = reader.rest().trim_ascii().len();
    let mut source = faces.into_source(points, 0);
    if rest > 0 {
        source.annotations.remark(format!("{rest} bytes after the elements that the header counts were left out"));
    }
    Ok(source)
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Property {
    name: String,
    /// The type of the number of items, if it is a list.
    list: Option<Scalar>,
    scalar: Scalar,
}

/// What reads a number of a type.
type Scalar = fn(&mut Reader) -> Result<f64>;

fn type_named(name: &[u8]) -> Option<Scalar> {
    Some(match name {
        b"char" | b"int8" => real::<i8>,
        b"uchar" | b"uint8" => real::<u8>,
        b"short" | b"int16" => real::<i16>,
        b"ushort" | b"uint16" => real::<u16>,
        b"int" | b"int32" => real::<i32>,
        b"uint" | b"uint32" => real::<u32>,
        b"float" | b"float32" => real::<f32>,
        b"double" | b"float64" => real::<f64>,
        _ => return None,
    })
}

fn real<T: Number + Into<f64>>(reader: &mut Reader) -> Result<f64> {
    if reader.encoding == Encoding::Text { reader.number() } else { reader.number::<T>().map(T::into) }
}

/// A number of items, or an index.
fn whole(scalar: Scalar, reader: &mut Reader) -> Result<u64> {
    let value = scalar(reader)?;
    // From there on whole numbers are not exact as numbers with a point.
    if value >= 0.0 && value.fract() == 0.0 && value < 2f64.powi(53) {
        return Ok(value as u64);
    }
    Err(reader.expected("a whole number of at least zero", &value.to_string()))
}

impl Property {
    fn skip(&self, reader: &mut Reader) -> Result<()> {
        let items = match self.list {
            Some(count) => whole(count, reader)?,
            None => 1,
        };
        (0..items).try_for_each(|_| (self.scalar)(reader).map(drop))
    }
}

fn header(reader: &mut Reader) -> Result<Vec<Element>> {
    reader.enter("header");
    if reader.line().trim_ascii() != b"ply" {
        return Err(
            Error::expected("header", "the word \"ply\" on the first line", "another").of_kind(ErrorKind::Syntax)
        );
    }
    let mut elements: Vec<Element> = Vec::new();
    let mut encoding = None;
    loop {
        if reader.rest().is_empty() {
            return Err(reader.ends());
        }
        // The line is read after its faults have been found, so that they name it.
        let line = reader.rest_of_line();
        match words(line).collect::<Vec<_>>()[..] {
            [b"format", format, _] => {
                encoding = Some(match format {
                    b"ascii" => Encoding::Text,
                    b"binary_little_endian" => Encoding::Binary { big_endian: false },
                    b"binary_big_endian" => Encoding::Binary { big_endian: true },
                    _ => {
                        return Err(
                            reader.expected("ascii, binary_little_endian or binary_big_endian", &quoted(format))
                        );
                    }
                });
            }
            [b"element", name, count] => {
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                let count = count.ok_or_else(|| reader.expected("a number of elements", &quoted(line)))?;
                elements.push(Element {
                    name: String::from_utf8_lossy(name).into_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            [b"property", ref types @ .., name] => {
                let [list, scalar] = match types {
                    [scalar] => [None, Some(*scalar)],
                    [b"list", count, scalar] => [Some(*count), Some(*scalar)],
                    _ => [None, None],
                };
                let known =
                    |name: &[u8]| type_named(name).ok_or_else(|| reader.expected("a type of numbers", &quoted(name)));
                let list = list.map(known).transpose()?;
                let scalar = known(scalar.unwrap_or_default())?;
                let Some(element) = elements.last_mut() else {
                    return Err(reader.expected("an element before its properties", &quoted(line)));
                };
                element.properties.push(Property { name: String::from_utf8_lossy(name).into_owned(), list, scalar });
            }
            [b"end_header"] => break,
            [] | [b"comment" | b"obj_info", ..] => {}
            _ => return Err(reader.expected("a line of a PLY header", &quoted(line))),
        }
        reader.line();
    }
    let Some(encoding) = encoding else { return Err(reader.expected("a line such as \"format ascii 1.0\"", "none")) };
    reader.line();
    reader.encoding = encoding;
    Ok(elements)
}

fn vertices(reader: &mut Reader, element: &Element, points: &mut Vec<[f64; 3]>) -> Result<()> {
    let find = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_none());
    let axes = ["x", "y", "z"].map(find);
    if axes.iter().any(Option::is_none) {
        return Err(reader.expected("properties x, y and z", "others"));
    }
    // The count of a header is not believed: memory is taken for no more than the bytes that follow can hold.
    points.reserve(reader.capacity::<f32>(element.count, 3));
    for _ in 0..element.count {
        let mut point = [0.0; 3];
        for (index, property) in element.properties.iter().enumerate() {
            match axes.iter().position(|axis| *axis == Some(index)) {
                Some(k) => point[k] = (property.scalar)(reader)?,
                None => property.skip(reader)?,
            }
        }
        points.push(point);
        reader.count_one();
    }
    Ok(())
}

fn polygons(reader: &mut Reader, element: &Element, points: &[[f64; 3]], faces: &mut Faces) -> Result<()> {
    let point_count = points.len();
    let is_corners = |p: &Property| p.list.is_some() && (p.name == "vertex_indices" || p.name == "vertex_index");
    let Some(corners) = element.properties.iter().position(is_corners) else {
        return Err(reader.expected("a list vertex_indices", "none"));
    };
    let mut nodes = Vec::new();
    for face in 0..element.count {
        for (index, property) in element.properties.iter().enumerate() {
            let Some(count) = property.list.filter(|_| index == corners) else {
                property.skip(reader)?;
                continue;
            };
            let count = whole(count, reader)?;
            nodes.clear();
            for _ in 0..count {
                let node = whole(property.scalar, reader)?;
                let known = usize::try_from(node).ok().filter(|&node| node < point_count);
                let expected = || reader.expected(&format!("an index below {point_count}"), &node.to_string());
                nodes.push(known.ok_or_else(expected)?);
            }
            if nodes.len() < 3 || !faces.push(&nodes, points) {
                let found = format!("face {face} with {count} corners");
                return Err(reader.expected(TRIANGULATE, &found).of_kind(ErrorKind::Unsupported));
            }
        }
        reader.count_one();
    }
    Ok(())
}
