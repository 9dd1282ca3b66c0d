//! Progress reports of a study.

/// What a study reports while it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event<'a> {
    /// A step of a stage is complete.
    Stage {
        /// The name of the stage.
        name: &'a str,
        /// The number of finished steps.
        done: usize,
        /// The number of all steps; 0 where it is not known.
        total: usize,
    },
    /// A message for the user that should be shown at once.
    Note(&'a str),
}

/// A callback for each [`Event`].
pub type Progress<'a> = dyn FnMut(Event) + 'a;

impl<'a> Event<'a> {
    /// The event that `done` of `total` steps of the stage `name` are complete.
    pub fn stage(name: &'a str, done: usize, total: usize) -> Event<'a> {
        Event::Stage { name, done, total }
    }
}
