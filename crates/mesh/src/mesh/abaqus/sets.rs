//! Sets of nodes or elements, and surfaces, before the numbers in them have been found.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::indices::Indices;
use crate::mesh::listing::missing;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Sets of one kind by name.
#[derive(Default, Clone)]
pub(super) struct Sets {
    pub sets: Vec<Set>,
    places: HashMap<String, usize>,
}

/// What a set lists.
#[derive(Default, Clone)]
pub(super) struct Set {
    pub name: String,
    /// The instance of the part that has the set.
    pub instance: Option<String>,
    /// The line on which it was first named.
    pub line: usize,
    pub numbers: Vec<u64>,
    /// First, last and step.
    pub ranges: Vec<[u64; 3]>,
    /// Indices of sets of the same kind, all before this one; they count with the members that they have at last.
    pub sets: Vec<usize>,
    /// Indices of sets of elements whose nodes belong to this set.
    pub of_elements: Vec<usize>,
    /// Whether its numbers keep the order of the file where it bounds what a keyword makes.
    pub is_unsorted: bool,
}

impl Sets {
    /// The index of the set with this name, which is added if it is new. Names are compared without regard to case.
    pub fn named(&mut self, name: &str, line: usize) -> usize {
        let next = self.sets.len();
        let place = *self.places.entry(name.to_uppercase()).or_insert(next);
        if place == next {
            self.sets.push(Set { name: name.to_string(), line, ..Set::default() });
        }
        place
    }

    pub fn find(&self, name: &str) -> Option<usize> {
        self.places.get(&name.to_uppercase()).copied()
    }

    /// The numbers that a set has so far, in the order in which keywords that make nodes go through them: ascending, or as they are listed. `numbers`
    /// are those that exist, for ranges. `None` if an unsorted set is not one list.
    pub fn so_far(&self, set: usize, numbers: &[u64]) -> Option<Vec<u64>> {
        let of = &self.sets[set];
        if of.is_unsorted {
            return (of.ranges.is_empty() && of.sets.is_empty()).then(|| of.numbers.clone());
        }
        let (mut found, mut waiting, mut met) = (BTreeSet::new(), vec![set], HashSet::from([set]));
        while let Some(set) = waiting.pop() {
            let of = &self.sets[set];
            found.extend(&of.numbers);
            for &[from, to, step] in &of.ranges {
                found.extend(numbers.iter().filter(|&&n| from <= n && n <= to && (n - from).is_multiple_of(step)));
            }
            waiting.extend(of.sets.iter().filter(|&&other| met.insert(other)));
        }
        Some(found.into_iter().collect())
    }

    /// Adds the sets of an instance, whose names begin with its own, and whose numbers grow by so much.
    ///
    /// # Errors
    /// A number becomes too large.
    pub fn add(&mut self, part: Sets, instance: &str, by: u64, of_elements: usize) -> Result<()> {
        let first = self.sets.len();
        for (place, mut set) in part.sets.into_iter().enumerate() {
            let grown = |number: &mut u64| number.checked_add(by).map(|new| *number = new);
            let numbers = set.numbers.iter_mut().try_for_each(grown);
            let ranges = set.ranges.iter_mut().try_for_each(|[from, to, _]| grown(from).and_then(|()| grown(to)));
            if numbers.and(ranges).is_none() {
                return Err(Error::at(
                    format!("set \"{}\"", set.name),
                    "has numbers that are too large in an assembly",
                ));
            }
            set.sets.iter_mut().for_each(|other| *other += first);
            set.of_elements.iter_mut().for_each(|other| *other += of_elements);
            self.places.insert(format!("{instance}.{}", set.name).to_uppercase(), first + place);
            set.instance = Some(instance.to_string());
            self.sets.push(set);
        }
        Ok(())
    }

    /// The members of each set as indices, ascending. `left_out` are numbers of things that are not read.
    ///
    /// # Errors
    /// A set names a number that is not there, or the sets have more than `most` members in all.
    pub fn members(
        &self,
        what: &str,
        numbers: &[u64],
        places: &Indices,
        left_out: &HashSet<u64>,
        most: usize,
    ) -> Result<Vec<Vec<usize>>> {
        let mut members: Vec<Vec<usize>> = Vec::with_capacity(self.sets.len());
        let mut total = 0;
        for set in &self.sets {
            let mut list = Vec::new();
            for &number in &set.numbers {
                match places.index(number) {
                    Some(place) => list.push(place),
                    None if left_out.contains(&number) => {}
                    None => return Err(missing(format!("set \"{}\"", set.name), set.line, what, number)),
                }
            }
            for &range in &set.ranges {
                // Numbers in a range need not exist.
                let (found, walked) = places.in_range(numbers, range);
                list.extend(found);
                total += walked;
                check(total, most)?;
            }
            for &other in &set.sets {
                list.extend(&members[other]);
                check(total + list.len(), most)?;
            }
            list.sort_unstable();
            list.dedup();
            total += list.len();
            check(total, most)?;
            members.push(list);
        }
        Ok(members)
    }
}

fn check(found: usize, most: usize) -> Result<()> {
    if found > most {
        let expected = format!("at most {most} members in a file of this length");
        return Err(Error::expected("sets", expected, "more").of_kind(ErrorKind::Limit));
    }
    Ok(())
}

/// A part of a surface: what it is on, and where on it.
#[derive(Clone)]
pub(super) struct Patch {
    pub on: On,
    pub place: Place,
}

#[derive(Clone)]
pub(super) enum On {
    Element(u64),
    /// The index of a set of elements.
    Elements(usize),
    /// The index of a set of nodes.
    Nodes(usize),
    Node(u64),
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// The side with this index; of a shell the first two are its faces, and the others its edges.
    Side(usize),
    /// The edge of a shell with this index.
    Edge(usize),
    /// The sides that belong to one element alone.
    Outer,
    /// The element itself: a face of a shell.
    Whole,
}
