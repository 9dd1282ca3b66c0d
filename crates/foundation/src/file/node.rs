//! The values of a TOML text as a tree, and their way into structures.
//!
//! A structure that is described by serde is compiled once for each kind of reader. There is one kind here, whether the tree comes from a
//! text or from a table, and it keeps the key and the place of a fault by itself.

use crate::text::{is_expression, not_a_line};
use serde::de::value::StringDeserializer;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use std::fmt::{self, Display};
use toml::Value;
use toml::de::{DeTable, DeValue};

/// What a value is. Dates are texts.
enum Content {
    Text(String),
    Whole(i128),
    Number(f64),
    /// A number that no type holds.
    TooLarge,
    Truth(bool),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A value and where it begins: its first byte in the text, if it comes from one.
struct Node {
    content: Content,
    place: Option<usize>,
}

/// A key of a table, where it stands, and its value.
struct Entry {
    key: String,
    place: Option<usize>,
    node: Node,
}

/// Why a tree does not fit a structure.
#[derive(Debug)]
pub(super) struct Fault {
    pub message: String,
    /// The key of what is wrong, such as `load[0].force`; it is empty if that is the whole text.
    pub key: Option<String>,
    /// The first byte of what is wrong.
    pub place: Option<usize>,
}

impl Fault {
    /// Adds the way to the value and its place, unless a value inside it has told its own.
    fn at(mut self, way: &Way, place: Option<usize>) -> Fault {
        self.key.get_or_insert_with(|| way.to_string());
        self.place = self.place.or(place);
        self
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

impl serde::de::Error for Fault {
    fn custom<T: Display>(message: T) -> Fault {
        Fault { message: message.to_string(), key: None, place: None }
    }
}

/// The keys that lead to a value, from the value to the root.
enum Way<'w> {
    Root,
    Key(&'w Way<'w>, &'w str),
    Item(&'w Way<'w>, usize),
}

impl Display for Way<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Way::Root => Ok(()),
            Way::Key(Way::Root, key) => f.write_str(key),
            Way::Key(parent, key) => write!(f, "{parent}.{key}"),
            Way::Item(parent, item) => write!(f, "{parent}[{item}]"),
        }
    }
}

/// Reads a parsed text into a structure.
pub(super) fn structure_of_text<T: DeserializeOwned>(root: DeTable<'_>, place: usize) -> Result<T, Fault> {
    let node = Node { content: entries(root), place: Some(place) };
    check_texts(&node, &Way::Root, false)?;
    T::deserialize(At { node, way: &Way::Root })
}

/// Reads a table into a structure.
pub(super) fn structure_of_table<T: DeserializeOwned>(table: toml::Table) -> Result<T, Fault> {
    let node = Node::from(Value::Table(table));
    check_texts(&node, &Way::Root, false)?;
    T::deserialize(At { node, way: &Way::Root })
}

/// Checks that keys and texts are printable lines, but for the line ends of expressions.
fn check_texts(node: &Node, way: &Way, in_expression: bool) -> Result<(), Fault> {
    let wrong = |problem| Fault::custom(problem).at(way, node.place);
    match &node.content {
        Content::Text(text) => not_a_line(text, in_expression).map_or(Ok(()), |problem| Err(wrong(problem))),
        Content::List(items) => {
            let mut items = items.iter().enumerate();
            items.try_for_each(|(i, item)| check_texts(item, &Way::Item(way, i), in_expression))
        }
        Content::Table(entries) => entries.iter().try_for_each(|Entry { key, place, node }| {
            if let Some(problem) = not_a_line(key, false) {
                return Err(Fault::custom(problem).at(way, *place));
            }
            check_texts(node, &Way::Key(way, key), in_expression || is_expression(key))
        }),
        Content::Whole(_) | Content::Number(_) | Content::TooLarge | Content::Truth(_) => Ok(()),
    }
}

fn entries(table: DeTable<'_>) -> Content {
    let entry = |(key, value): (toml::Spanned<_>, toml::Spanned<DeValue<'_>>)| {
        let place = Some(key.span().start);
        let key: toml::de::DeString<'_> = key.into_inner();
        Entry { key: key.into_owned(), place, node: node(value) }
    };
    Content::Table(table.into_iter().map(entry).collect())
}

fn node(value: toml::Spanned<DeValue<'_>>) -> Node {
    let place = Some(value.span().start);
    let content = match value.into_inner() {
        DeValue::String(text) => Content::Text(text.into_owned()),
        DeValue::Integer(number) => {
            i128::from_str_radix(number.as_str(), number.radix()).map_or(Content::TooLarge, Content::Whole)
        }
        DeValue::Float(number) => match number.as_str().parse::<f64>() {
            Ok(value) if value.is_finite() || !number.as_str().contains(|c: char| c.is_ascii_digit()) => {
                Content::Number(value)
            }
            _ => Content::TooLarge,
        },
        DeValue::Boolean(truth) => Content::Truth(truth),
        DeValue::Datetime(date) => Content::Text(date.to_string()),
        DeValue::Array(items) => Content::List(items.into_iter().map(node).collect()),
        DeValue::Table(table) => entries(table),
    };
    Node { content, place }
}

impl Content {
    /// What serde calls it in a message.
    fn unexpected(&self) -> Unexpected<'_> {
        match self {
            Content::Text(text) => Unexpected::Str(text),
            Content::Whole(number) => i64::try_from(*number).map_or(Unexpected::Other("integer"), Unexpected::Signed),
            Content::Number(number) => Unexpected::Float(*number),
            Content::TooLarge => Unexpected::Other("number that is too large"),
            Content::Truth(truth) => Unexpected::Bool(*truth),
            Content::List(_) => Unexpected::Seq,
            Content::Table(_) => Unexpected::Map,
        }
    }
}

impl From<Value> for Node {
    fn from(value: Value) -> Node {
        let content = match value {
            Value::String(text) => Content::Text(text),
            Value::Integer(number) => Content::Whole(number.into()),
            Value::Float(number) => Content::Number(number),
            Value::Boolean(truth) => Content::Truth(truth),
            Value::Datetime(date) => Content::Text(date.to_string()),
            Value::Array(items) => Content::List(items.into_iter().map(Node::from).collect()),
            Value::Table(table) => {
                let entry = |(key, value)| Entry { key, place: None, node: Node::from(value) };
                Content::Table(table.into_iter().map(entry).collect())
            }
        };
        Node { content, place: None }
    }
}

/// A value and the way to it.
struct At<'w> {
    node: Node,
    way: &'w Way<'w>,
}

impl<'de> Deserializer<'de> for At<'_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let At { node: Node { content, place }, way } = self;
        let read = match content {
            Content::Text(text) => visitor.visit_string(text),
            Content::Whole(number) => match (i64::try_from(number), u64::try_from(number)) {
                (Ok(number), _) => visitor.visit_i64(number),
                (_, Ok(number)) => visitor.visit_u64(number),
                _ => visitor.visit_i128(number),
            },
            Content::Number(number) => visitor.visit_f64(number),
            Content::TooLarge => Err(Fault::custom("the number is too large")),
            Content::Truth(truth) => visitor.visit_bool(truth),
            Content::List(items) => visitor.visit_seq(Items { items: items.into_iter().enumerate(), way }),
            Content::Table(entries) => visitor.visit_map(Entries { entries: entries.into_iter(), value: None, way }),
        };
        read.map_err(|fault| fault.at(way, place))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let (way, place) = (self.way, self.node.place);
        visitor.visit_some(self).map_err(|fault| fault.at(way, place))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Fault> {
        let (way, place) = (self.way, self.node.place);
        visitor.visit_newtype_struct(self).map_err(|fault| fault.at(way, place))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let At { node: Node { content, place }, way } = self;
        let read = match content {
            Content::Text(name) => visitor.visit_enum(name.into_deserializer()),
            Content::Table(mut entries) if entries.len() == 1 => {
                let entry = entries.pop().expect("there is one");
                visitor.visit_enum(Variant { entry, way })
            }
            table @ Content::Table(_) => Err(Fault::invalid_value(table.unexpected(), &"a table with one key")),
            other => Err(Fault::invalid_type(other.unexpected(), &"a string or a table")),
        };
        read.map_err(|fault| fault.at(way, place))
    }

    forward_to_deserialize_any! {
        bool u8 u16 u32 u64 u128 i8 i16 i32 i64 i128 f32 f64 char str string seq bytes byte_buf map unit ignored_any
        unit_struct tuple_struct tuple identifier struct
    }
}

struct Items<'w> {
    items: std::iter::Enumerate<std::vec::IntoIter<Node>>,
    way: &'w Way<'w>,
}

impl<'de> SeqAccess<'de> for Items<'_> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        let Some((number, node)) = self.items.next() else { return Ok(None) };
        let (way, place) = (Way::Item(self.way, number), node.place);
        seed.deserialize(At { node, way: &way }).map(Some).map_err(|fault| fault.at(&way, place))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

struct Entries<'w> {
    entries: std::vec::IntoIter<Entry>,
    value: Option<(String, Node)>,
    way: &'w Way<'w>,
}

/// The name of a key, or of a variant.
fn read_name<'de, T: DeserializeSeed<'de>>(seed: T, name: String) -> Result<T::Value, Fault> {
    let name: StringDeserializer<Fault> = name.into_deserializer();
    seed.deserialize(name)
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Fault;

    fn next_key_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        let Some(Entry { key, place, node }) = self.entries.next() else { return Ok(None) };
        let (key, _) = self.value.insert((key, node));
        read_name(seed, key.clone()).map(Some).map_err(|fault| fault.at(&Way::Key(self.way, key), place))
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Fault> {
        let (key, node) = self.value.take().ok_or_else(|| Fault::custom("a value was asked for before its key"))?;
        let (way, place) = (Way::Key(self.way, &key), node.place);
        seed.deserialize(At { node, way: &way }).map_err(|fault| fault.at(&way, place))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.entries.len())
    }
}

/// A variant that has content: the one key of a table.
struct Variant<'w> {
    entry: Entry,
    way: &'w Way<'w>,
}

/// The content of a variant.
struct VariantContent<'w> {
    name: String,
    node: Node,
    way: &'w Way<'w>,
}

impl<'de, 'w> EnumAccess<'de> for Variant<'w> {
    type Error = Fault;
    type Variant = VariantContent<'w>;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, VariantContent<'w>), Fault> {
        let Variant { entry: Entry { key, place, node }, way } = self;
        let variant = read_name(seed, key.clone()).map_err(|fault| fault.at(way, place))?;
        Ok((variant, VariantContent { name: key, node, way }))
    }
}

impl<'de> VariantAccess<'de> for VariantContent<'_> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        let problem = match &self.node.content {
            Content::Table(entries) if entries.is_empty() => return Ok(()),
            Content::List(items) if items.is_empty() => return Ok(()),
            _ => Fault::custom("expected an empty table"),
        };
        Err(problem.at(&Way::Key(self.way, &self.name), self.node.place))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(At { node: self.node, way: &Way::Key(self.way, &self.name) })
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Fault> {
        At { node: self.node, way: &Way::Key(self.way, &self.name) }.deserialize_seq(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], visitor: V) -> Result<V::Value, Fault> {
        At { node: self.node, way: &Way::Key(self.way, &self.name) }.deserialize_map(visitor)
    }
}
