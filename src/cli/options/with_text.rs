//! Option values with their original text, which image metadata records.

use super::lists::List;
use serde_json::json;
use std::ops::Deref;
use std::str::FromStr;

/// A value and its text on the command line.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct WithText<T> {
    text: String,
    value: T,
}

impl<T> Deref for WithText<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: FromStr> FromStr for WithText<T> {
    type Err = T::Err;

    fn from_str(text: &str) -> Result<Self, T::Err> {
        Ok(Self { text: text.to_owned(), value: text.parse()? })
    }
}

impl<T> WithText<T> {
    pub(in crate::cli) fn text(&self) -> &str {
        &self.text
    }
}

/// Adds the texts of values to a list, if there are any.
pub(in crate::cli) fn insert<'a, T: 'a>(
    list: &mut List,
    name: &str,
    values: impl IntoIterator<Item = &'a WithText<T>>,
) {
    let texts: Vec<&str> = values.into_iter().map(WithText::text).collect();
    if !texts.is_empty() {
        list.insert(name.to_owned(), json!(texts.join("; ")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_their_text() {
        let typed: Vec<WithText<f64>> = ["1e2", "0.50"].map(|text| text.parse().unwrap()).into();
        assert_eq!((*typed[0], *typed[1]), (100.0, 0.5));
        let mut list = List::new();
        insert(&mut list, "numbers", &typed);
        insert(&mut list, "none", None::<&WithText<f64>>);
        assert_eq!(list.into_iter().collect::<Vec<_>>(), [("numbers".into(), "1e2; 0.50".into())]);
    }
}
