//! Tables as text for the terminal.

use super::Table;

/// Gap between columns.
const GAP: &str = "  ";

impl Table {
    /// Formats the table as lines. Groups and units have a line each if there are any. Text is aligned
    /// left, numbers right.
    pub fn text(&self) -> String {
        let columns: Vec<Vec<String>> = (0..self.columns.len()).map(|i| self.lines(i)).collect();
        let count = columns.first().map_or(0, Vec::len);
        let mut lines = vec![String::new(); count];
        let mut groups = String::new();
        for (i, column) in columns.iter().enumerate() {
            let gap = if i == 0 { "" } else { GAP };
            let group = &self.columns[i].group;
            if !group.is_empty() {
                let start = lines.first().map_or(0, |line| line.chars().count());
                groups = format!("{groups:<start$}{gap}{group}");
            }
            let width = column.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
            let left = i == 0 || self.rows.iter().any(|row| row[i].is_text());
            for (line, cell) in lines.iter_mut().zip(column) {
                let cell = if left { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
                *line += gap;
                *line += &cell;
            }
        }
        let groups = (!groups.is_empty()).then_some(groups);
        groups.iter().chain(&lines).fold(String::new(), |text, line| text + line.trim_end() + "\n")
    }

    /// Returns name, unit and cells of a column.
    fn lines(&self, i: usize) -> Vec<String> {
        let column = &self.columns[i];
        let mut lines = vec![column.name.clone()];
        if self.columns.iter().any(|column| !column.unit.is_empty()) {
            lines.push(column.unit.clone());
        }
        lines.extend(self.rows.iter().map(|row| row[i].text(column.style)));
        lines
    }
}

#[cfg(test)]
mod tests {
    use crate::report::{Cell, Column, Spread, Style, Table};

    #[test]
    fn columns_are_aligned_with_their_headings() {
        let columns = vec![
            Column::new("scene", ""),
            Column::new("rays", "").group("how many"),
            Column::new("rate", "").unit("Mrays/s").style(Style::Fixed(1)).group("how fast"),
            Column::new("walk", ""),
        ];
        let mut table = Table::new("a", "A", columns);
        let spread = Spread { median: 2.0, least: 1.0, greatest: 30.0 };
        table.push(["small".into(), 1000_u64.into(), spread.into(), "single".into()]);
        table.push(["large one".into(), Cell::None, 2.5.into()]);
        assert_eq!(
            table.text(),
            "           how many  how fast\n\
             scene       rays             rate  walk\n\
             \x20                         Mrays/s\n\
             small      1,000  2.0 (1.0..30.0)  single\n\
             large one      -              2.5  -\n"
        );
    }
}
