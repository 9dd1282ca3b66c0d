//! Numbers that are kept: values of the function while loops are unrolled, otherwise an array of the function.

use super::body::Body;
use super::function::Role;
use super::index::Index;
use super::value::Value;

/// So many numbers, all zero at first.
#[derive(Debug, Clone)]
pub enum Room {
    /// Values, for places that are known when the function is written.
    Values(Vec<Value>),
    /// An array of the function.
    Array(usize),
}

impl Room {
    /// Room for so many numbers; an array of the function with `is_array`.
    pub fn new(body: &Body, name: &str, length: usize, is_array: bool) -> Room {
        if !is_array {
            return Room::Values(vec![body.number(0.0); length]);
        }
        let (array, zero) = (body.array(name, length, Role::Work), body.number(0.0));
        body.each(false, 0, length, |i| body.store(array, i, &zero));
        Room::Array(array)
    }

    /// An array that is written before it is read.
    pub fn unset(body: &Body, name: &str, length: usize, is_array: bool) -> Room {
        if is_array { Room::Array(body.array(name, length, Role::Work)) } else { Room::new(body, name, length, false) }
    }

    /// The number at this place.
    pub fn get(&self, body: &Body, at: impl Into<Index>) -> Value {
        match self {
            Room::Values(values) => values[known(&at.into())].clone(),
            Room::Array(array) => body.entry(*array, at),
        }
    }

    /// Replaces the number at this place.
    pub fn set(&mut self, body: &Body, at: impl Into<Index>, value: &Value) {
        match self {
            Room::Values(values) => values[known(&at.into())] = value.clone(),
            Room::Array(array) => body.store(*array, at, value),
        }
    }

    /// Adds to the number at this place.
    pub fn add(&mut self, body: &Body, at: impl Into<Index>, value: &Value) {
        let at = at.into();
        let sum = self.get(body, &at) + value;
        self.set(body, at, &sum);
    }
}

fn known(at: &Index) -> usize {
    at.number().expect("values are kept only for loops that are unrolled")
}
