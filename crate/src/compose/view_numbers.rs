//! Views by their numbers, as pages are named to a printer: `1-12, 20`.

/// Some of a scan's views. People count them from 1, the program from 0.
///
/// ```
/// use snellius::compose::ViewNumbers;
///
/// let mut views = ViewNumbers::read("1-3, 7", 9)?;
/// assert!(views.has(2) && !views.has(3));
/// views.set(3, true);
/// assert_eq!(views.to_string(), "1-4, 7");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ViewNumbers(Vec<bool>);

impl ViewNumbers {
    /// Reads numbers and ranges of so many views, or says what is wrong with them.
    pub fn read(text: &str, views: usize) -> Result<Self, String> {
        let plain = text.replace(['\u{2013}', '\u{2212}'], "-");
        let parts = plain.split([',', ';']).map(str::trim);
        let mut numbers = vec![false; views];
        for part in parts.filter(|part| !part.is_empty()) {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let (first, last) = (number(first, views)?, number(last, views)?);
            if last < first {
                return Err(format!("{part} goes backwards"));
            }
            numbers[first - 1..last].fill(true);
        }
        Ok(Self(numbers))
    }

    /// Whether a view, counted from 0, is among them.
    pub fn has(&self, view: usize) -> bool {
        self.0.get(view) == Some(&true)
    }

    /// Takes a view, counted from 0, in or out.
    pub fn set(&mut self, view: usize, is_in: bool) {
        if let Some(known) = self.0.get_mut(view) {
            *known = is_in;
        }
    }
}

/// A number of a view, counted from 1.
fn number(word: &str, views: usize) -> Result<usize, String> {
    let word = word.trim();
    let number = word.parse().ok();
    number
        .filter(|number| (1..=views).contains(number))
        .ok_or_else(|| match word.parse::<usize>() {
            Ok(_) if views == 0 => format!("there is no view {word} yet"),
            Ok(_) => format!("there is no view {word}; they go from 1 to {views}"),
            Err(_) => format!("\"{word}\" is no number of a view"),
        })
}

impl std::fmt::Display for ViewNumbers {
    /// As it is read.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut between = "";
        let mut first = 0;
        while first < self.0.len() {
            let many = self.0[first..].iter().take_while(|is_in| **is_in).count();
            match many {
                0 => {}
                1 => write!(f, "{between}{}", first + 1)?,
                _ => write!(f, "{between}{}-{}", first + 1, first + many)?,
            }
            if many > 0 {
                between = ", ";
            }
            first += many + 1;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them_and_written_shortly() {
        for (text, written) in [
            ("", ""),
            ("3", "3"),
            ("1-3,5", "1-3, 5"),
            ("5; 1 \u{2013} 3, 4", "1-5"),
            ("2,1", "1-2"),
        ] {
            let views = ViewNumbers::read(text, 5).map(|views| views.to_string());
            assert_eq!(views.as_deref(), Ok(written), "{text}");
        }
    }

    #[test]
    fn what_is_no_view_is_said() {
        for (text, why) in [
            ("0", "there is no view 0; they go from 1 to 5"),
            ("4-6", "there is no view 6; they go from 1 to 5"),
            ("4-2", "4-2 goes backwards"),
            ("all", "\"all\" is no number of a view"),
            ("1 2", "\"1 2\" is no number of a view"),
            (
                "99999999999999999999999",
                "\"99999999999999999999999\" is no number of a view",
            ),
        ] {
            assert_eq!(ViewNumbers::read(text, 5), Err(why.to_owned()), "{text}");
        }
    }
}
