//! How far a study has come.

/// What a study reports while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event<'a> {
    /// `done` of `total` steps of a stage are complete.
    Stage { name: &'a str, done: usize, total: usize },
    /// A message for the user that does not wait for the end.
    Note(&'a str),
}

/// Called with each [`Event`].
pub type Progress<'a> = dyn FnMut(Event) + 'a;

impl<'a> Event<'a> {
    pub fn stage(name: &'a str, done: usize, total: usize) -> Event<'a> {
        Event::Stage { name, done, total }
    }
}
