//! The table as Parquet.

use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use super::{Cells, Column, Table};

impl Table {
    /// As Parquet: doubles, 64-bit whole numbers and texts, each of which may be missing.
    ///
    /// # Errors
    /// [`ParquetError`], for a table whose columns have different lengths.
    pub fn to_parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let fields = self.columns.iter().map(field).collect::<Result<Vec<TypePtr>, _>>()?;
        let schema = Arc::new(Type::group_type_builder("study").with_fields(fields).build()?);
        let properties = Arc::new(WriterProperties::builder().build());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, properties)?;
        let mut group = writer.next_row_group()?;
        for column in &self.columns {
            if let Some(mut writer) = group.next_column()? {
                write(&column.cells, &mut writer)?;
                writer.close()?;
            }
        }
        group.close()?;
        writer.into_inner()
    }
}

fn field(column: &Column) -> Result<TypePtr, ParquetError> {
    let physical = match column.cells {
        Cells::Numbers(_) => Physical::DOUBLE,
        Cells::Integers(_) => Physical::INT64,
        Cells::Texts(_) => Physical::BYTE_ARRAY,
    };
    let field = Type::primitive_type_builder(&column.name, physical).with_repetition(Repetition::OPTIONAL);
    let field = match column.cells {
        Cells::Texts(_) => field.with_logical_type(Some(LogicalType::String)).with_converted_type(ConvertedType::UTF8),
        _ => field,
    };
    Ok(Arc::new(field.build()?))
}

fn write(cells: &Cells, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
    match cells {
        Cells::Numbers(cells) => {
            let (values, levels) = present(cells);
            writer.typed::<DoubleType>().write_batch(&values, Some(&levels), None)?;
        }
        Cells::Integers(cells) => {
            let (values, levels) = present(cells);
            writer.typed::<Int64Type>().write_batch(&values, Some(&levels), None)?;
        }
        Cells::Texts(cells) => {
            let (values, levels) = present(cells);
            let values: Vec<ByteArray> = values.iter().map(|text| ByteArray::from(text.as_str())).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)?;
        }
    }
    Ok(())
}

/// The existing values, and for each row whether there is one.
fn present<T: Clone>(cells: &[Option<T>]) -> (Vec<T>, Vec<i16>) {
    (cells.iter().flatten().cloned().collect(), cells.iter().map(|cell| i16::from(cell.is_some())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    #[test]
    fn what_is_written_is_read_again() {
        let mut table = Table::default();
        table.push("f", Cells::Numbers(vec![Some(0.1), None, Some(f64::MAX)]));
        table.push("n", Cells::Integers(vec![None, Some(-3), Some(i64::MAX)]));
        table.push("why", Cells::Texts(vec![Some("ä, \"b\"".into()), None, Some(String::new())]));
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("t.parquet");
        std::fs::write(&path, table.to_parquet().unwrap()).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        assert_eq!(rows[0], [Field::Double(0.1), Field::Null, Field::Str("ä, \"b\"".into())]);
        assert_eq!(rows[1], [Field::Null, Field::Long(-3), Field::Null]);
        assert_eq!(rows[2], [Field::Double(f64::MAX), Field::Long(i64::MAX), Field::Str(String::new())]);
    }
}
