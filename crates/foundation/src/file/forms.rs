//! Values that can be written in more than one form.

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor};
use std::fmt;

/// A function of this type reads a text. Its error has an explanation, if there is a more specific one than what was expected.
type OfText<'a, T> = &'a dyn Fn(&str) -> Result<T, Option<String>>;
/// A function of this type reads a list. Its error says why the list is refused.
type OfList<T, L> = fn(L) -> Result<T, &'static str>;

/// This visitor reads a value that can be written in several forms: those for which it has a function. A list is read as an `L`, and a table
/// as an `M`.
pub struct Forms<'a, T, L, M> {
    /// The error for a value in none of the forms says that this was expected.
    pub expected: &'static str,
    /// This function reads a number, whole or not. It gives none for a number that is refused.
    pub number: Option<fn(f64) -> Option<T>>,
    /// This function reads a text.
    pub text: Option<OfText<'a, T>>,
    /// This function reads a list.
    pub list: Option<OfList<T, L>>,
    /// This function reads a table.
    pub table: Option<fn(M) -> T>,
}

/// This visitor reads a value that is neither a list nor a table.
pub type PlainForms<'a, T> = Forms<'a, T, IgnoredAny, IgnoredAny>;

impl<T, L, M> Forms<'_, T, L, M> {
    /// Makes a visitor that accepts no value yet.
    pub fn expecting(expected: &'static str) -> Self {
        Forms { expected, number: None, text: None, list: None, table: None }
    }
}

impl<'de, T, L: Deserialize<'de>, M: Deserialize<'de>> Visitor<'de> for Forms<'_, T, L, M> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_i64<E: de::Error>(self, v: i64) -> Result<T, E> {
        match self.number {
            Some(_) => self.visit_f64(v as f64),
            None => Err(E::invalid_type(Unexpected::Signed(v), &self)),
        }
    }

    fn visit_f64<E: de::Error>(self, v: f64) -> Result<T, E> {
        let number = self.number.ok_or_else(|| E::invalid_type(Unexpected::Float(v), &self))?;
        number(v)
            .ok_or_else(|| E::custom(format!("expected {}, found {}", self.expected, v.to_string().to_lowercase())))
    }

    fn visit_str<E: de::Error>(self, v: &str) -> Result<T, E> {
        let text = self.text.ok_or_else(|| E::invalid_type(Unexpected::Str(v), &self))?;
        let plain = || E::invalid_value(Unexpected::Str(v), &self);
        text(v).map_err(|problem| problem.map_or_else(plain, E::custom))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<T, A::Error> {
        let Some(of_list) = self.list else { return Err(de::Error::invalid_type(Unexpected::Seq, &self)) };
        of_list(L::deserialize(SeqAccessDeserializer::new(list))?).map_err(de::Error::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        let Some(of_table) = self.table else { return Err(de::Error::invalid_type(Unexpected::Map, &self)) };
        M::deserialize(MapAccessDeserializer::new(map)).map(of_table)
    }
}
