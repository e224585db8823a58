//! Reports as CSV and JSON.

use super::{Cell, Machine, Report, Spread, Table};
use serde_json::{Map, Value, json};

/// Suffixes of the column names for the numbers of a spread.
const SPREAD_SUFFIXES: [&str; 3] = ["", " least", " greatest"];

impl Table {
    /// Returns the table as CSV in UTF-8, with a header of names and units. A column of numbers that
    /// were measured several times becomes three: median, minimum and maximum. Cells that are missing
    /// or not finite are empty.
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = self.columns.iter().enumerate().flat_map(|(i, column)| {
            let count = if self.has_spread(i) { SPREAD_SUFFIXES.len() } else { 1 };
            SPREAD_SUFFIXES[..count]
                .iter()
                .map(|part| column.with_unit(&format!("{}{part}", column.name)))
        });
        // Writing to memory cannot fail, and rows have equal lengths.
        let _ = writer.write_record(header);
        for row in &self.rows {
            let cells = row.iter().enumerate().flat_map(|(i, cell)| self.record(i, cell));
            let _ = writer.write_record(cells);
        }
        String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
    }

    /// Returns the fields of a cell in column `i`.
    fn record(&self, i: usize, cell: &Cell) -> Vec<String> {
        let number = |x: f64| if x.is_finite() { x.to_string() } else { String::new() };
        let mut fields = match cell {
            Cell::None => vec![String::new()],
            Cell::Text(text) => vec![text.clone()],
            Cell::Count(count) => vec![count.to_string()],
            Cell::Number(x) => vec![number(*x)],
            Cell::Spread(Spread { median, least, greatest }) => {
                [median, least, greatest].map(|x| number(*x)).to_vec()
            }
        };
        if self.has_spread(i) {
            fields.resize(SPREAD_SUFFIXES.len(), String::new());
        }
        fields
    }

    fn json(&self) -> Value {
        let columns = self.columns.iter().map(
            |column| json!({ "name": column.name, "unit": column.unit, "about": column.about }),
        );
        let rows = self.rows.iter().map(|row| {
            let cells = self.columns.iter().zip(row);
            Value::Object(cells.map(|(column, cell)| (column.name.clone(), value(cell))).collect())
        });
        json!({
            "name": self.name,
            "title": self.title,
            "columns": columns.collect::<Vec<_>>(),
            "rows": rows.collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }
}

/// Returns a cell as JSON; null if it is missing or not finite.
fn value(cell: &Cell) -> Value {
    match cell {
        Cell::None => Value::Null,
        Cell::Text(text) => json!(text),
        Cell::Count(count) => json!(count),
        Cell::Number(number) => json!(number),
        Cell::Spread(spread) => json!(spread),
    }
}

impl Report {
    /// Returns the report as a JSON object, with the machine and the tables. Rows are objects whose
    /// keys are the columns' names.
    pub fn json(&self, machine: &Machine) -> Value {
        let strings = |pairs: &[(String, String)]| {
            let pairs = pairs.iter().map(|(name, text)| (name.clone(), json!(text)));
            Value::Object(pairs.collect::<Map<_, _>>())
        };
        json!({
            "name": self.name,
            "title": self.title,
            "about": self.about,
            "machine": strings(&machine.facts),
            "settings": strings(&self.settings),
            "tables": self.tables.iter().map(Table::json).collect::<Vec<_>>(),
        })
    }

    /// Returns whether the content of a file is a report by [`Report::json`].
    pub fn is_json(content: &[u8]) -> bool {
        let Ok(report) = serde_json::from_slice::<Value>(content) else { return false };
        report["machine"]["version"].is_string() && report["tables"].is_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Column;

    fn table() -> Table {
        let columns =
            vec![Column::new("name", "name"), Column::new("rate", "rate").unit("Mrays/s")];
        let mut table = Table::new("a", "A", columns);
        let spread = Spread { median: 2.0, least: 1.5, greatest: 1e-9 };
        table.push(["one, \"two\"".into(), spread.into()]);
        table.push([Cell::None, Cell::Number(f64::INFINITY)]);
        table
    }

    #[test]
    fn csv_has_all_digits_and_all_fields() {
        assert_eq!(
            table().csv(),
            "name,rate [Mrays/s],rate least [Mrays/s],rate greatest [Mrays/s]\n\
             \"one, \"\"two\"\"\",2,1.5,0.000000001\n\
             ,,,\n"
        );
    }

    #[test]
    fn json_rows_have_column_names_as_keys() {
        let machine = Machine { facts: vec![("threads".into(), "2".into())] };
        let report = Report { tables: vec![table()], ..Report::default() };
        let json = report.json(&machine);
        assert_eq!(json["machine"]["threads"], "2");
        let table = &json["tables"][0];
        assert_eq!(table["columns"][1]["unit"], "Mrays/s");
        assert_eq!(table["rows"][0]["rate"]["least"], 1.5);
        assert_eq!(table["rows"][1]["rate"], Value::Null);
    }
}
