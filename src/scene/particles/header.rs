//! Which column of a CSV file is what.

use csv::StringRecord;

/// Columns of a CSV file, by their places.
pub(super) struct Header {
    pub(super) position: [usize; 3],
    /// The column and the factor that makes it a radius.
    pub(super) radius: Option<(usize, f64)>,
    pub(super) color: Option<[usize; 3]>,
    pub(super) material: Option<usize>,
    /// Names of the columns that say nothing here.
    pub(super) unused: Vec<String>,
}

impl Header {
    /// Tells columns by their names, in any case.
    ///
    /// # Errors
    ///
    /// What is missing, or there twice.
    pub(super) fn new(names: &StringRecord) -> Result<Self, String> {
        let find = |wanted: &str| names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        for (column, name) in names.iter().enumerate() {
            if find(name) != Some(column) {
                return Err(format!("two columns are named `{name}`"));
            }
        }
        let need =
            |wanted: &str| find(wanted).ok_or_else(|| format!("no column is named `{wanted}`"));
        let position = [need("x")?, need("y")?, need("z")?];
        let all = |names: [&str; 3]| {
            let [red, green, blue] = names.map(find);
            Some([red?, green?, blue?])
        };
        let color = all(["red", "green", "blue"]).or_else(|| all(["r", "g", "b"]));
        // `r` beside `g` and `b` is red.
        let short = find("r").filter(|r| color.is_none_or(|color| color[0] != *r));
        let whole = find("radius").or(short).map(|column| (column, 1.0));
        let radius = whole.or_else(|| find("diameter").map(|column| (column, 0.5)));
        let material = find("material");
        let mut header = Self { position, radius, color, material, unused: Vec::new() };
        header.unused = header.unused(names);
        Ok(header)
    }

    fn unused(&self, names: &StringRecord) -> Vec<String> {
        let radius = self.radius.map(|(column, _)| column);
        let color = self.color.into_iter().flatten();
        let used: Vec<usize> =
            self.position.into_iter().chain(radius).chain(color).chain(self.material).collect();
        let columns = names.iter().enumerate().filter(|(column, _)| !used.contains(column));
        columns.map(|(_, name)| name.to_owned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &str) -> Result<Header, String> {
        Header::new(&names.split(',').collect::<Vec<_>>().into())
    }

    #[test]
    fn names_decide_in_any_case_and_order() {
        let found = header("Z,y,X,id,Diameter,MATERIAL").ok();
        let found = found.map(|found| (found.position, found.radius, found.material, found.unused));
        assert_eq!(found, Some(([2, 1, 0], Some((4, 0.5)), Some(5), vec!["id".to_owned()])));
    }

    #[test]
    fn r_is_red_beside_g_and_b_and_else_a_radius() {
        let both = |names: &str| header(names).map(|found| (found.radius, found.color));
        assert_eq!(both("x,y,z,r"), Ok((Some((3, 1.0)), None)));
        assert_eq!(both("x,y,z,r,g"), Ok((Some((3, 1.0)), None)));
        assert_eq!(both("x,y,z,radius,r,g,b"), Ok((Some((3, 1.0)), Some([4, 5, 6]))));
        assert_eq!(both("x,y,z,r,red,green,blue"), Ok((Some((3, 1.0)), Some([4, 5, 6]))));
        assert_eq!(both("x,y,z,r,g,b"), Ok((None, Some([3, 4, 5]))));
    }

    #[test]
    fn missing_and_double_columns_are_told() {
        assert!(header("x,y").is_err_and(|message| message.contains("`z`")));
        assert!(header("x,y,z,X").is_err_and(|message| message.contains("two columns")));
    }
}
