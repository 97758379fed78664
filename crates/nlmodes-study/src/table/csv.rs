//! The table as CSV.

use super::Table;

impl Table {
    /// As CSV with a header. Numbers are the shortest that read back as the same double.
    pub fn to_csv(&self) -> Vec<u8> {
        let mut writer = ::csv::Writer::from_writer(Vec::new());
        let mut write = |record: Vec<String>| writer.write_record(record);
        // Writing to a vector cannot fail.
        let _ = write(self.columns.iter().map(|column| column.name.clone()).collect());
        for row in 0..self.n_rows() {
            let _ = write(self.columns.iter().map(|column| column.cells.text(row)).collect());
        }
        writer.into_inner().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cells;
    use super::*;

    #[test]
    fn cells_are_quoted_where_they_must_be_and_empty_where_there_is_nothing() {
        let mut table = Table::default();
        table.push("f", Cells::Numbers(vec![Some(0.1 + 0.2), None]));
        table.push("why", Cells::Texts(vec![Some("a, \"b\"".into()), None]));
        let text = String::from_utf8(table.to_csv()).unwrap();
        assert_eq!(text, "f,why\n0.30000000000000004,\"a, \"\"b\"\"\"\n,\n");
    }
}
