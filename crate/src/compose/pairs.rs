//! Which picture with the laser on goes with which one with it off: their names say it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::names::{Word, common_folder, stem, words};

/// The pictures of a view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// What the names of both have in common.
    pub id: String,
    /// The name of the picture with the laser on.
    pub on: String,
    /// The name of the one with the laser off.
    pub off: Option<String>,
    /// What it is sorted and looked for by.
    pub(super) key: Vec<Word>,
}

/// A picture that goes with no other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unpaired {
    /// Its name.
    pub picture: String,
    /// Why.
    pub lack: Lack,
    /// The view that it makes by itself, unless the laser is off in it.
    pub alone: Option<Pair>,
}

/// What a picture lacks to make a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lack {
    /// The laser is on, and there is no picture with it off.
    Off,
    /// The laser is off, and there is no picture with it on.
    On,
    /// Its name does not say whether the laser is on.
    Unclear,
    /// Several pictures have the same name but for the laser.
    Several,
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "no picture of that name with the laser off",
            Self::On => "no picture of that name with the laser on",
            Self::Unclear => "its name does not say whether the laser is on or off",
            Self::Several => "several pictures have this name but for the laser",
        })
    }
}

/// Pictures, paired.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pairing {
    /// In natural order: view 9 before view 10.
    pub pairs: Vec<Pair>,
    /// The pictures that are left.
    pub unpaired: Vec<Unpaired>,
}

/// Whether a name is that of a picture that an archive may hold.
pub fn is_picture(name: &str) -> bool {
    let file = name.rsplit('/').next().unwrap_or(name);
    // macOS puts `._NAME` beside each file on foreign disks.
    stem(name).1.is_some() && !file.starts_with('.')
}

/// Pairs pictures by their names, paths with `/`. What is in every name tells nothing, so a scan may lie
/// in a folder `laser/`.
///
/// ```
/// let names = ["view10_on.png", "view9_on.png", "view9_off.png", "view10_off.png", "view11_on.png"];
/// let pairing = snellius::compose::pair(&names);
/// let ids: Vec<_> = pairing.pairs.iter().map(|pair| pair.id.as_str()).collect();
/// assert_eq!(ids, ["view9", "view10"]);
/// assert_eq!(pairing.unpaired[0].picture, "view11_on.png");
/// ```
pub fn pair(names: &[impl AsRef<str>]) -> Pairing {
    let names: BTreeSet<&str> = set(names.iter().map(AsRef::as_ref));
    let names: Vec<&str> = names.into_iter().filter(|name| is_picture(name)).collect();
    let folder = common_folder(&names);
    let shared = shared_words(&names, folder);
    let mut groups: BTreeMap<Vec<Word>, Group> = BTreeMap::new();
    for name in names {
        let named = Named::new(name, folder, &shared);
        let group = groups.entry(named.key.clone()).or_default();
        group.of(named.light).push(named);
    }
    let mut pairing = Pairing::default();
    for group in groups.into_values() {
        group.settle(&mut pairing);
    }
    pairing
}

/// To `collect` it would sort the items first, by a program for each type.
fn set<T: Ord>(items: impl Iterator<Item = T>) -> BTreeSet<T> {
    let mut set = BTreeSet::new();
    set.extend(items);
    set
}

/// The words that all names have; none if there is but one.
fn shared_words(names: &[&str], folder: &str) -> BTreeSet<Word> {
    let of = |name: &&str| -> BTreeSet<Word> {
        let words = words(stem(&name[folder.len()..]).0);
        set(words.into_iter().map(|(word, _)| word))
    };
    let mut all = names.iter().map(of);
    let Some(first) = all.next().filter(|_| names.len() > 1) else {
        return BTreeSet::new();
    };
    all.fold(first, |shared, words| &shared & &words)
}

#[derive(Clone, Copy)]
enum Light {
    On,
    Off,
    Unsaid,
}

/// A picture by what its name says.
struct Named {
    name: String,
    light: Light,
    /// The words that do not tell the laser,
    key: Vec<Word>,
    /// and how they are written.
    id: String,
}

impl Named {
    fn new(name: &str, folder: &str, shared: &BTreeSet<Word>) -> Self {
        let text = stem(&name[folder.len()..]).0;
        let tells = |word: &Word| !shared.contains(word) && word.tells_the_laser();
        let (told, kept): (Vec<_>, Vec<_>) =
            words(text).into_iter().partition(|(word, _)| tells(word));
        let light = if told.iter().any(|(word, _)| word.says_off()) {
            Light::Off
        } else if told.is_empty() {
            Light::Unsaid
        } else {
            Light::On
        };
        let mut id = String::new();
        let mut end = None;
        for (_, range) in &kept {
            // What stood between two words stays, unless a word for the laser was there.
            match end {
                Some(end)
                    if told
                        .iter()
                        .any(|(_, r)| r.start >= end && r.end <= range.start) =>
                {
                    id.push('-');
                }
                Some(end) => id.push_str(&text[end..range.start]),
                None => {}
            }
            id.push_str(&text[range.clone()]);
            end = Some(range.end);
        }
        Self {
            name: name.to_owned(),
            light,
            key: kept.into_iter().map(|(word, _)| word).collect(),
            id: if id.is_empty() { text.to_owned() } else { id },
        }
    }

    fn view(&self, off: Option<&Self>) -> Pair {
        Pair {
            id: self.id.clone(),
            on: self.name.clone(),
            off: off.map(|off| off.name.clone()),
            key: self.key.clone(),
        }
    }

    fn left(&self, lack: Lack) -> Unpaired {
        let alone = matches!(lack, Lack::Off | Lack::Unclear);
        Unpaired {
            picture: self.name.clone(),
            lack,
            alone: alone.then(|| self.view(None)),
        }
    }
}

/// Pictures whose names are the same but for the laser.
#[derive(Default)]
struct Group {
    on: Vec<Named>,
    off: Vec<Named>,
    unsaid: Vec<Named>,
}

impl Group {
    fn of(&mut self, light: Light) -> &mut Vec<Named> {
        match light {
            Light::On => &mut self.on,
            Light::Off => &mut self.off,
            Light::Unsaid => &mut self.unsaid,
        }
    }

    /// Beside one that says it, a picture that says nothing is the other one.
    fn settle(self, into: &mut Pairing) {
        match (&*self.on, &*self.off, &*self.unsaid) {
            ([on], [off], []) | ([on], [], [off]) | ([], [off], [on]) => {
                into.pairs.push(on.view(Some(off)));
            }
            ([on], [], []) => into.unpaired.push(on.left(Lack::Off)),
            ([], [off], []) => into.unpaired.push(off.left(Lack::On)),
            ([], [], [one]) => into.unpaired.push(one.left(Lack::Unclear)),
            (on, off, unsaid) => {
                let all = on.iter().chain(off).chain(unsaid);
                into.unpaired.extend(all.map(|one| one.left(Lack::Several)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Id, on, off of each pair.
    fn pairs(names: &[&str]) -> Vec<[String; 3]> {
        let pairing = pair(names);
        assert_eq!(pairing.unpaired, [], "{names:?}");
        let pairs = pairing.pairs.into_iter();
        pairs
            .map(|pair| [pair.id, pair.on, pair.off.unwrap_or_default()])
            .collect()
    }

    #[test]
    fn names_of_many_habits_are_paired() {
        let habits: [[&str; 5]; 10] = [
            [
                "view01",
                "view01_on.png",
                "view02_on.png",
                "view01_off.png",
                "view02_off.png",
            ],
            [
                "001",
                "on/001.png",
                "on/002.png",
                "off/001.png",
                "off/002.png",
            ],
            [
                "0001",
                "images/0001-on.tif",
                "images/0002-on.tif",
                "images/0001-off.tif",
                "images/0002-off.tif",
            ],
            [
                "s-1",
                "s-laser-1.png",
                "s-laser-2.png",
                "s-dark-1.png",
                "s-dark-2.png",
            ],
            [
                "7",
                "laser_on_7.jpg",
                "laser_on_8.jpg",
                "laser_off_7.jpg",
                "laser_off_8.jpg",
            ],
            ["a1", "a1.png", "a2.png", "a1_dark.png", "a2_dark.png"],
            ["a1", "a1_laser.png", "a2_laser.png", "a1.png", "a2.png"],
            [
                "3",
                "LaserOn3.png",
                "LaserOn4.png",
                "LaserOff3.png",
                "LaserOff4.png",
            ],
            [
                "5",
                "with laser/5.png",
                "with laser/6.png",
                "without laser/5.png",
                "without laser/6.png",
            ],
            [
                "1",
                "laser/on/1.png",
                "laser/on/2.png",
                "laser/off/01.png",
                "laser/off/02.png",
            ],
        ];
        for [id, on, other_on, off, other_off] in habits {
            let found = pairs(&[other_off, on, off, other_on]);
            // A word that all names share may stay in the id.
            assert!(found[0][0].ends_with(id), "{found:?}");
            assert_eq!(found[0][1..], [on, off], "{found:?}");
            assert_eq!(found[1][1..], [other_on, other_off], "{found:?}");
        }
    }

    #[test]
    fn views_come_in_natural_order() {
        let found = pairs(&["10on.png", "10off.png", "9on.png", "9off.png"]);
        assert_eq!([&found[0][0], &found[1][0]], ["9", "10"]);
    }

    #[test]
    fn what_is_left_says_why() {
        let pairing = pair(&[
            "1_on.png",
            "1_off.png",
            "2_on.png",
            "3_off.png",
            "4.png",
            "5_on.png",
            "5-on.png",
            "5_off.png",
            "notes.txt",
            "._1_on.png",
        ]);
        let left: Vec<_> = pairing
            .unpaired
            .iter()
            .map(|one| (one.picture.as_str(), one.lack, one.alone.is_some()))
            .collect();
        assert_eq!(
            left,
            [
                ("2_on.png", Lack::Off, true),
                ("3_off.png", Lack::On, false),
                ("4.png", Lack::Unclear, true),
                ("5-on.png", Lack::Several, false),
                ("5_on.png", Lack::Several, false),
                ("5_off.png", Lack::Several, false),
            ]
        );
        assert_eq!(pairing.pairs.len(), 1);
    }

    #[test]
    fn a_word_in_every_name_tells_nothing() {
        let pairing = pair(&["dark room 1.png", "dark room 2.png"]);
        assert!(pairing.unpaired.iter().all(|one| one.lack == Lack::Unclear));
    }
}
