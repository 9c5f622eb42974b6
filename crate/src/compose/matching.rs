//! Which pose belongs to which view.

use std::collections::BTreeMap;

use super::names::{Word, stem, words};
use super::pairs::Pair;
use super::poses::{ListedPose, PoseList};
use crate::text::{count, some_of};

/// The pose of each view, or the sentences on why they do not fit.
pub(super) fn match_poses<'a>(
    views: &[Pair],
    list: &'a PoseList,
) -> Result<Vec<&'a ListedPose>, Vec<String>> {
    let by_name = by_name(views, list);
    if list.named {
        return by_name;
    }
    // Times may be the pictures' names, and may be nobody's.
    by_name.or_else(|_| in_order(views, list))
}

fn in_order<'a>(views: &[Pair], list: &'a PoseList) -> Result<Vec<&'a ListedPose>, Vec<String>> {
    if views.len() == list.poses.len() {
        return Ok(list.poses.iter().collect());
    }
    Err(vec![format!(
        "{}, but {}; where the list names no views they are matched by their order.",
        count(views.len(), "view"),
        count(list.poses.len(), "pose")
    )])
}

fn by_name<'a>(views: &[Pair], list: &'a PoseList) -> Result<Vec<&'a ListedPose>, Vec<String>> {
    let register = Register::of(views);
    let mut found: Vec<Option<&ListedPose>> = vec![None; views.len()];
    let (mut strangers, mut twice) = (Vec::new(), Vec::new());
    for pose in &list.poses {
        let name = pose.name.as_deref().unwrap_or_default();
        match register.view(name) {
            None => strangers.push(name),
            Some(view) if found[view].replace(pose).is_some() => twice.push(name),
            Some(_) => {}
        }
    }
    let lacking = views.iter().zip(&found).filter(|(_, pose)| pose.is_none());
    let lacking: Vec<&str> = lacking.map(|(view, _)| view.id.as_str()).collect();
    let mut gaps = Vec::new();
    let mut complain = |names: &[&str], noun: &str, what: &str| {
        if !names.is_empty() {
            let count = count(names.len(), noun);
            gaps.push(format!("{count} {what}: {}.", some_of(names)));
        }
    };
    complain(&lacking, "view", "without a pose");
    complain(&twice, "pose", "for a view that has one already");
    // Poses of pictures that are not here do no harm, unless others are missing.
    if !lacking.is_empty() {
        complain(&strangers, "pose", "for no view");
    }
    let all: Option<Vec<_>> = found.into_iter().collect();
    all.filter(|_| gaps.is_empty()).ok_or(gaps)
}

/// The views by what a list may call them.
struct Register<'a> {
    names: BTreeMap<&'a str, usize>,
    words: BTreeMap<Vec<Word>, usize>,
}

impl<'a> Register<'a> {
    fn of(views: &'a [Pair]) -> Self {
        let mut names = BTreeMap::new();
        let mut words = BTreeMap::new();
        for (index, view) in views.iter().enumerate() {
            let own = [Some(&view.id), Some(&view.on), view.off.as_ref()];
            names.extend(own.into_iter().flatten().map(|name| (name.as_str(), index)));
            words.insert(without_laser(view.key.clone()), index);
        }
        Self { names, words }
    }

    /// The view of a name: its id, one of its pictures, or the same words as in its pictures' names.
    fn view(&self, name: &str) -> Option<usize> {
        if let Some(view) = self.names.get(name) {
            return Some(*view);
        }
        let mut path = stem(name).0;
        loop {
            let own = words(path).into_iter().map(|(word, _)| word).collect();
            if let Some(view) = self.words.get(&without_laser(own)) {
                return Some(*view);
            }
            // A list may name folders that are not here.
            path = path.split_once(['/', '\\'])?.1;
        }
    }
}

/// Whether the laser is on, a list may say or not.
fn without_laser(mut words: Vec<Word>) -> Vec<Word> {
    words.retain(|word| !word.tells_the_laser());
    words
}
