//! A sentence that a reader must know before trusting a result, with what it costs not to know it.

/// What it costs not to know a note. The dearest comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// A model has no answer, or one that is wrong.
    Broken,
    /// Errors are relative to what is not right itself.
    Reference,
    /// A network is not the body that was asked for.
    Model,
    /// How a fit came to its constants.
    Fit,
    /// All else.
    Detail,
}

/// A sentence, in parts: `head`, the subjects, `words`, `figures` and `advice`. Notes that differ in their subjects and figures alone are one
/// sentence of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    weight: Weight,
    head: String,
    subjects: Vec<String>,
    words: String,
    figures: String,
    advice: String,
}

impl Note {
    /// A sentence about the body.
    pub fn of_body(weight: Weight, words: impl Into<String>) -> Note {
        let [head, figures, advice] = [const { String::new() }; 3];
        Note { weight, head, subjects: Vec::new(), words: words.into(), figures, advice }
    }

    /// A sentence about a model, whose name goes first.
    pub fn of_model(weight: Weight, name: &str, words: impl AsRef<str>) -> Note {
        let words = format!(": {}", words.as_ref());
        Note { subjects: vec![name.into()], ..Note::of_body(weight, words) }
    }

    /// A sentence in which the name of a load stands between `head` and `words`.
    pub fn of_load(weight: Weight, head: &str, name: &str, words: impl Into<String>) -> Note {
        Note { head: head.into(), subjects: vec![name.into()], ..Note::of_body(weight, words) }
    }

    /// Adds what differs from subject to subject. A sentence of several subjects has it if they have the same.
    pub fn figures(self, figures: impl Into<String>) -> Note {
        Note { figures: figures.into(), ..self }
    }

    /// Adds what the reader can do.
    pub fn advice(self, advice: impl Into<String>) -> Note {
        Note { advice: advice.into(), ..self }
    }

    /// The sentence.
    pub fn sentence(&self) -> String {
        let Note { head, words, figures, advice, .. } = self;
        format!("{head}{}{words}{figures}{advice}", self.subjects.join(", "))
    }

    /// Whether the notes differ in their subjects and figures alone.
    fn is_alike(&self, other: &Note) -> bool {
        let parts = |note: &Note| (note.weight, note.head.clone(), note.words.clone(), note.advice.clone());
        !self.subjects.is_empty() && !other.subjects.is_empty() && parts(self) == parts(other)
    }
}

/// The notes in the order of what they cost, otherwise as they come.
pub fn ordered(mut notes: Vec<Note>) -> Vec<Note> {
    notes.sort_by_key(|note| note.weight);
    notes
}

/// The notes in the order of what they cost, one for all that differ in their subjects and figures alone.
pub fn grouped(notes: Vec<Note>) -> Vec<Note> {
    let mut groups: Vec<Note> = Vec::new();
    for note in ordered(notes) {
        match groups.iter_mut().find(|known| known.is_alike(&note)) {
            Some(known) => {
                if known.figures != note.figures {
                    known.figures.clear();
                }
                known.subjects.extend(note.subjects);
            }
            None => groups.push(note),
        }
    }
    groups
}
