//! The values of a comparison as Apache Parquet, which pandas, Polars, R and DuckDB read.

use super::values::{LongTable, Values};
use crate::error::{Error, Result};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

impl LongTable {
    /// The bytes of a file with one group of rows; a value that is missing is null.
    ///
    /// # Errors
    /// The library refuses the table.
    pub fn parquet(&self) -> Result<Vec<u8>> {
        self.encoded().map_err(|e| Error::new(format!("the table cannot be written as Parquet: {e}")))
    }

    fn encoded(&self) -> parquet::errors::Result<Vec<u8>> {
        let field = |(name, values): &(String, Values)| {
            let (physical, logical) = match values {
                Values::Texts(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                Values::Numbers(_) => (Physical::DOUBLE, None),
            };
            let field = Type::primitive_type_builder(name, physical).with_logical_type(logical);
            field.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
        };
        let fields = self.columns.iter().map(field).collect::<parquet::errors::Result<Vec<_>>>()?;
        let schema = Arc::new(Type::group_type_builder("comparison").with_fields(fields).build()?);
        let mut bytes = Vec::new();
        let mut file = SerializedFileWriter::new(&mut bytes, schema, Arc::new(WriterProperties::new()))?;
        let mut group = file.next_row_group()?;
        for (_, values) in &self.columns {
            let Some(mut column) = group.next_column()? else { break };
            match values {
                Values::Numbers(list) => {
                    let known: Vec<f64> = list.iter().copied().flatten().collect();
                    column.typed::<DoubleType>().write_batch(&known, Some(&levels(list)), None)?;
                }
                Values::Texts(list) => {
                    let known: Vec<ByteArray> = list.iter().flatten().map(|text| text.as_str().into()).collect();
                    column.typed::<ByteArrayType>().write_batch(&known, Some(&levels(list)), None)?;
                }
            }
            column.close()?;
        }
        group.close()?;
        file.close()?;
        Ok(bytes)
    }
}

/// 1 where there is a value, 0 where it is missing.
fn levels<T>(list: &[Option<T>]) -> Vec<i16> {
    list.iter().map(|value| i16::from(value.is_some())).collect()
}
