//! The words of a picture's name: what two names have in common, and what tells the laser.

use std::ops::Range;

/// The kinds of picture that archives may hold.
const EXTENSIONS: [&str; 7] = ["png", "tif", "tiff", "jpg", "jpeg", "webp", "bmp"];

/// Words for the laser being on,
const ON: [&str; 7] = ["on", "laser", "laseron", "lit", "bright", "with", "spot"];
/// and off. They count more: `laser_off` has one of each.
const OFF: [&str; 10] = [
    "off",
    "laseroff",
    "nolaser",
    "dark",
    "ambient",
    "background",
    "bg",
    "unlit",
    "without",
    "no",
];

/// A word of a name, to be compared: `007` is `7`, `View` is `view`. Numbers come before texts, and 9
/// before 10.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Word {
    Number(u64),
    Text(String),
}

impl Word {
    fn new(text: &str) -> Self {
        match text.parse() {
            Ok(number) => Self::Number(number),
            Err(_) => Self::Text(text.to_lowercase()),
        }
    }

    /// Whether it says something of the laser.
    pub(super) fn tells_the_laser(&self) -> bool {
        self.says_off() || self.is_one_of(&ON)
    }

    /// Whether it says that the laser is off.
    pub(super) fn says_off(&self) -> bool {
        self.is_one_of(&OFF)
    }

    fn is_one_of(&self, texts: &[&str]) -> bool {
        matches!(self, Self::Text(text) if texts.contains(&text.as_str()))
    }
}

/// A name without the ending that tells a picture's format, and that ending.
pub(super) fn stem(name: &str) -> (&str, Option<&str>) {
    match name.rsplit_once('.') {
        Some((stem, ending)) if EXTENSIONS.contains(&ending.to_lowercase().as_str()) => {
            (stem, Some(ending))
        }
        _ => (name, None),
    }
}

/// The words of a text and where they stand. A word ends where letters, digits and other signs meet, and
/// where a capital follows a small letter: `laserOn_007` has three.
pub(super) fn words(text: &str) -> Vec<(Word, Range<usize>)> {
    let mut words = Vec::new();
    let mut start = 0;
    let mut before = Kind::Other;
    for (at, letter) in text.char_indices().chain([(text.len(), '\0')]) {
        let kind = Kind::of(letter);
        let goes_on = kind == before || (before == Kind::Capital && kind == Kind::Small);
        if !goes_on {
            if before != Kind::Other {
                words.push((Word::new(&text[start..at]), start..at));
            }
            start = at;
        }
        before = kind;
    }
    words
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Digit,
    Capital,
    Small,
    Other,
}

impl Kind {
    fn of(letter: char) -> Self {
        match letter {
            '0'..='9' => Self::Digit,
            letter if letter.is_uppercase() => Self::Capital,
            letter if letter.is_alphabetic() => Self::Small,
            _ => Self::Other,
        }
    }
}

/// The folder that all names lie in, with its slash.
pub(super) fn common_folder<'a>(names: &[&'a str]) -> &'a str {
    let folder = |name: &'a str| &name[..name.rfind('/').map_or(0, |end| end + 1)];
    let mut folders = names.iter().map(|name| folder(name));
    let Some(mut common) = folders.next() else {
        return "";
    };
    for other in folders {
        while !other.starts_with(common) {
            let inner = common.trim_end_matches('/');
            common = folder(inner);
        }
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(name: &str) -> Vec<&str> {
        let words = words(name).into_iter();
        words.map(|(_, range)| &name[range]).collect()
    }

    #[test]
    fn a_word_ends_where_kinds_of_letters_meet() {
        assert_eq!(texts("laserOn_007"), ["laser", "On", "007"]);
        assert_eq!(
            texts("sweep 2/IMG0012-OFF"),
            ["sweep", "2", "IMG", "0012", "OFF"]
        );
        assert_eq!(texts("größe3"), ["größe", "3"]);
        assert!(texts("-._").is_empty());
    }

    #[test]
    fn nine_comes_before_ten() {
        let number = |name| words(name).remove(0).0;
        assert!(number("009") < number("10"));
        assert_eq!(number("007"), number("7"));
    }

    #[test]
    fn the_folder_of_all_names_is_the_longest_that_holds_them() {
        assert_eq!(common_folder(&["a/b/1.png", "a/b/2.png"]), "a/b/");
        assert_eq!(common_folder(&["a/on/1.png", "a/off/1.png"]), "a/");
        assert_eq!(common_folder(&["1.png", "a/2.png"]), "");
        assert_eq!(common_folder(&[]), "");
    }
}
