//! The line that the program prints about a fault: `error: file:line: key: problem`.

/// The file, the line and the key, each where the fault has one.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Place {
    file: Option<String>,
    line: Option<usize>,
    key: Option<String>,
}

#[derive(Debug, PartialEq, Eq)]
pub struct Message {
    pub place: Place,
    pub problem: String,
}

impl Place {
    /// Reads `file:line: key`. A file is known by its ending or by its folder, or is one of `files`.
    pub fn parse(text: &str, files: &[&str]) -> Place {
        let text = format!("{text}: ");
        let (place, rest) = Place::read(&text, files);
        assert_eq!(rest, "", "{text:?} is not a place");
        place
    }

    /// Whether this is the expected place. Errors of values in TOML files always have a line. If the expected place has no line, the
    /// line found must be one that holds the key or the table around it.
    pub fn is<'a>(&self, expected: &Place, text_of: impl Fn(&str) -> Option<&'a [u8]>) -> bool {
        if expected.line.is_some() || expected.key.is_none() || self.line.is_none() {
            let is_file =
                expected.file.as_deref().is_some_and(|file| file.ends_with(".toml") && text_of(file).is_some());
            let lines_needed = is_file && expected.key.is_some();
            return self == expected && (self.line.is_some() || !lines_needed || self.is_missing(&text_of));
        }
        let text = self.file.as_deref().and_then(&text_of).map(|text| String::from_utf8_lossy(text).into_owned());
        let line = |text: &String| text.lines().nth(self.line.unwrap_or(0).wrapping_sub(1)).map(String::from);
        let Some(line) = text.as_ref().and_then(line) else { return false };
        let names = self.names();
        let continues = line.starts_with([' ', '\t', '[']);
        (&self.file, &self.key) == (&expected.file, &expected.key)
            && (continues || names.iter().any(|name| line.contains(name)))
    }

    /// The parts of the key, without numbers.
    fn names(&self) -> Vec<&str> {
        let key = self.key.as_deref().unwrap_or_default();
        key.split('.').map(|part| part.split('[').next().unwrap_or(part)).collect()
    }

    /// Whether the file has nothing of the key: there is no line to name.
    fn is_missing<'a>(&self, text_of: &impl Fn(&str) -> Option<&'a [u8]>) -> bool {
        let text = self.file.as_deref().and_then(text_of).map(String::from_utf8_lossy).unwrap_or_default();
        self.names()
            .first()
            .is_none_or(|name| !text.contains(&format!("{name} =")) && !text.contains(&format!("[{name}")))
    }

    /// The place that `text` begins with, and what follows it.
    fn read<'a>(text: &'a str, files: &[&str]) -> (Place, &'a str) {
        let mut place = Place::default();
        let mut rest = text;
        if let Some((part, after)) = rest.split_once(": ") {
            let (file, line) = match part.rsplit_once(':') {
                Some((file, line)) => (file, line_number(line)),
                None => (part, None),
            };
            if is_file(file, files) && (line.is_some() || file == part) {
                (place.file, place.line, rest) = (Some(file.to_string()), line, after);
            }
        }
        if let Some((key, after)) = rest.split_once(": ")
            && is_key(key)
        {
            (place.key, rest) = (Some(key.to_string()), after);
        }
        (place, rest)
    }
}

impl Message {
    /// Reads what the program has printed on standard error; `None` unless it is one such line.
    pub fn parse(printed: &str, files: &[&str]) -> Option<Message> {
        let line = printed.strip_prefix("error: ")?.strip_suffix('\n')?;
        let (place, problem) = Place::read(line, files);
        let in_order = !problem.is_empty() && problem.trim() == problem && !line.contains(char::is_control);
        in_order.then(|| Message { place, problem: problem.to_string() })
    }

    /// Whether the problem has these words, not followed by more of the last word or number.
    pub fn has(&self, words: &str) -> bool {
        self.problem.match_indices(words).any(|(start, _)| {
            let mut after = self.problem[start + words.len()..].chars();
            match after.next() {
                Some('.') => !after.next().is_some_and(|c| c.is_ascii_digit()),
                next => !next.is_some_and(char::is_alphanumeric),
            }
        })
    }
}

fn line_number(text: &str) -> Option<usize> {
    text.parse().ok().filter(|line: &usize| *line > 0 && line.to_string() == text)
}

fn is_file(text: &str, files: &[&str]) -> bool {
    let endings = [".toml", ".msh", ".vtu", ".vtk", ".stl", ".csv", ".json"];
    text.contains('/') || endings.iter().any(|ending| text.ends_with(ending)) || files.contains(&text)
}

/// The path of a value, an option, or a node or a cell of a mesh.
fn is_key(text: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    if let Some(node) = text.strip_prefix("node ") {
        return digits(node);
    }
    if let Some((element, cell)) = text.split_once(" cell ") {
        let (cell, at) = cell.split_once(" at ").unwrap_or((cell, ""));
        return is_path(element) && digits(cell) && (at.is_empty() || at.starts_with('[') && at.ends_with("] m"));
    }
    is_path(text.strip_prefix("--").unwrap_or(text))
}

/// Names joined by dots, with indices: `nodes[3].shape`.
fn is_path(text: &str) -> bool {
    text.split('.').all(|step| {
        let (name, indices) = step.split_at(step.find('[').unwrap_or(step.len()));
        let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '$')
            && name.chars().skip(1).all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        let closed = indices.is_empty() || indices.ends_with(']');
        is_name && closed && indices.chars().all(|c| c.is_ascii_digit() || c == '[' || c == ']')
    })
}

#[test]
fn a_line_is_read_into_its_parts() {
    let read = |line: &str| {
        let Message { place, problem } = Message::parse(line, &["folder"])?;
        Some((place.file, place.line, place.key, problem))
    };
    let text = |text: &str| Some(text.to_string());
    let problem = || "expected one of a: b, found 0".to_string();
    for (line, found) in [
        ("a.toml:5: b[0].c: ", (text("a.toml"), Some(5), text("b[0].c"))),
        ("a.toml: b: ", (text("a.toml"), None, text("b"))),
        ("out/a: ", (text("out/a"), None, None)),
        ("folder: ", (text("folder"), None, None)),
        ("a.msh:12: $Nodes: ", (text("a.msh"), Some(12), text("$Nodes"))),
        ("a.msh: node 4: ", (text("a.msh"), None, text("node 4"))),
        ("a.msh: tet4 cell 1 at [0.0, 0.0] m: ", (text("a.msh"), None, text("tet4 cell 1 at [0.0, 0.0] m"))),
        ("--young: ", (None, None, text("--young"))),
        ("springs: ", (None, None, text("springs"))),
        ("", (None, None, None)),
    ] {
        let (file, line_number, key) = found;
        assert_eq!(read(&format!("error: {line}{}\n", problem())), Some((file, line_number, key, problem())), "{line}");
    }
}

#[test]
fn what_is_not_such_a_line_is_refused() {
    for printed in
        ["", "\n", "error: \n", "error: a.toml: b: \n", "a.toml: b: c\n", "error: a.toml: b: c", "error: a: c\nd\n"]
    {
        assert_eq!(Message::parse(printed, &[]), None, "{printed:?}");
    }
    let place = |line: &str| Message::parse(line, &[]).unwrap().place;
    assert_eq!(place("error: a.toml:05: b: c\n"), Place::default());
    assert_eq!(place("error: a.toml:0: b: c\n"), Place::default());
    assert_eq!(place("error: column 4: c\n"), Place::default());
    assert_ne!(Place::parse("a.toml:5: b", &[]), Place::parse("a.toml:6: b", &[]));
    assert_ne!(Place::parse("a.toml:5: b", &[]), Place::parse("a.toml: b", &[]));
    assert_ne!(Place::parse("a.toml: b", &[]), Place::parse("a.toml: b[0]", &[]));
}

#[test]
fn words_are_found_whole() {
    let message = Message::parse("error: expected a share, found 0.25 of 1e30\n", &[]).unwrap();
    for (words, found) in
        [("found 0.25", true), ("found 0", false), ("found 0.2", false), ("of 1e30", true), ("of 1e3", false)]
    {
        assert_eq!(message.has(words), found, "{words}");
    }
}
