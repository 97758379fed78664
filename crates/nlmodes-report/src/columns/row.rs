//! Rows of tables: a column is described in one place, as a field with its name, unit and meaning.
//!
//! From that field come the header, the cell that is written, the value that is read, the entry of `results.mat` and
//! the line of the documentation; a row without one of its columns does not compile.

use nlmodes_modal::{Event, InternalResonance};

use super::Column;

/// The content of a cell, or of several cells of a numbered column.
pub trait Cell: Sized {
    /// Whether it is text in `results.mat`.
    const IS_TEXT: bool = false;

    /// The names of its columns in the header; a numbered one, `participation_…`, has as many as there are values.
    fn names(&self, name: &str) -> Vec<String> {
        vec![name.to_owned()]
    }

    /// Its cells, one for each name.
    fn cells(&self) -> Vec<String>;

    /// The value of an empty cell, and of a table without such a column.
    fn unknown() -> Self;

    /// The value of a cell that is not empty; `None` where it holds something else.
    fn read(text: &str) -> Option<Self>;

    /// The value as a number, NaN where it is unknown or text.
    fn number(&self) -> f64 {
        f64::NAN
    }
}

/// The shortest decimal that reads back as the same double, with an exponent where it is shorter (`1e-12`); read, what
/// is not finite is NaN.
impl Cell for f64 {
    fn cells(&self) -> Vec<String> {
        vec![format!("{self:?}")]
    }

    fn unknown() -> Self {
        f64::NAN
    }

    fn read(text: &str) -> Option<Self> {
        text.parse::<f64>().ok().map(|value| if value.is_finite() { value } else { f64::NAN })
    }

    fn number(&self) -> f64 {
        *self
    }
}

/// A number of things.
impl Cell for usize {
    fn cells(&self) -> Vec<String> {
        vec![self.to_string()]
    }

    fn unknown() -> Self {
        0
    }

    fn read(text: &str) -> Option<Self> {
        let value = text.parse::<f64>().ok()?;
        (value >= 0.0 && value.fract() == 0.0).then_some(value as usize)
    }

    fn number(&self) -> f64 {
        *self as f64
    }
}

/// Read, whatever is not `true` is false.
impl Cell for bool {
    fn cells(&self) -> Vec<String> {
        vec![self.to_string()]
    }

    fn unknown() -> Self {
        false
    }

    fn read(text: &str) -> Option<Self> {
        Some(text == "true")
    }

    fn number(&self) -> f64 {
        f64::from(u8::from(*self))
    }
}

impl Cell for String {
    const IS_TEXT: bool = true;

    fn cells(&self) -> Vec<String> {
        vec![self.clone()]
    }

    fn unknown() -> Self {
        String::new()
    }

    fn read(text: &str) -> Option<Self> {
        Some(text.to_owned())
    }
}

/// Names separated by spaces; read, those that are unknown are left out.
impl Cell for Vec<Event> {
    const IS_TEXT: bool = true;

    fn cells(&self) -> Vec<String> {
        vec![Event::names(self)]
    }

    fn unknown() -> Self {
        Vec::new()
    }

    fn read(text: &str) -> Option<Self> {
        Some(text.split_whitespace().filter_map(Event::from_name).collect())
    }
}

/// `n:mode k`; read, what is something else is none.
impl Cell for Option<InternalResonance> {
    const IS_TEXT: bool = true;

    fn cells(&self) -> Vec<String> {
        vec![self.map_or_else(String::new, |resonance| resonance.to_string())]
    }

    fn unknown() -> Self {
        None
    }

    fn read(text: &str) -> Option<Self> {
        let number = |text: &str| text.parse::<usize>().ok();
        let parts = text.split_once(":mode ").and_then(|(n, k)| Some((number(n)?, number(k)?)));
        Some(parts.map(|(harmonic, mode)| InternalResonance { harmonic, mode }))
    }
}

/// What may be unknown.
pub trait Known: Cell {}
impl Known for f64 {}
impl Known for usize {}
impl Known for bool {}

/// Empty where it is not known.
impl<T: Known> Cell for Option<T> {
    fn cells(&self) -> Vec<String> {
        self.as_ref().map_or_else(|| vec![String::new()], T::cells)
    }

    fn unknown() -> Self {
        None
    }

    fn read(text: &str) -> Option<Self> {
        T::read(text).map(|value| Some(value).filter(|value| !value.number().is_nan()))
    }

    fn number(&self) -> f64 {
        self.as_ref().map_or(f64::NAN, T::number)
    }
}

/// A numbered column, from 1; it is not read.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbered<T>(pub Vec<T>);

impl<T: Cell> Cell for Numbered<T> {
    fn names(&self, name: &str) -> Vec<String> {
        (1..=self.0.len()).map(|k| name.replacen('…', &k.to_string(), 1)).collect()
    }

    fn cells(&self) -> Vec<String> {
        self.0.iter().flat_map(T::cells).collect()
    }

    fn unknown() -> Self {
        Self(Vec::new())
    }

    fn read(_: &str) -> Option<Self> {
        Some(Self(Vec::new()))
    }
}

/// A column that not every table of its kind has; all rows of one have it, or none.
#[derive(Debug, Clone, PartialEq)]
pub struct Sometimes<T>(pub Option<T>);

impl<T: Cell> Cell for Sometimes<T> {
    fn names(&self, name: &str) -> Vec<String> {
        self.0.iter().map(|_| name.to_owned()).collect()
    }

    fn cells(&self) -> Vec<String> {
        self.0.iter().flat_map(T::cells).collect()
    }

    fn unknown() -> Self {
        Self(None)
    }

    fn read(text: &str) -> Option<Self> {
        T::read(text).map(|value| Self(Some(value)))
    }
}

/// What is written as a row, behind a header.
pub trait Cells {
    /// The header of the table with rows like this.
    fn header(&self) -> Vec<String>;

    /// Its cells.
    fn cells(&self) -> Vec<String>;
}

/// A row with further columns behind its own.
impl<A: Cells, B: Cells> Cells for (A, B) {
    fn header(&self) -> Vec<String> {
        [self.0.header(), self.1.header()].concat()
    }

    fn cells(&self) -> Vec<String> {
        [self.0.cells(), self.1.cells()].concat()
    }
}

/// A row of a table.
pub trait Row: Cells + Sized {
    /// Its columns, in their order.
    const COLUMNS: &'static [Column];
    /// Whether each of them is text in `results.mat`.
    const TEXTS: &'static [bool];

    /// Its values as numbers, NaN where they are unknown or texts.
    fn numbers(&self) -> Vec<f64>;

    /// A row of which nothing is known.
    fn unknown() -> Self;

    /// The row whose cells are these, by the number of the column; empty ones where a table lacks a column.
    ///
    /// # Errors
    /// The column whose cell holds something else than it should.
    fn read<'t>(cell: impl FnMut(usize) -> &'t str) -> Result<Self, &'static Column>;
}

/// Defines a row: `field: type, "unit", "meaning";` for each column; the name of the field is that of the column, or
/// `field "name"` for another.
macro_rules! row {
    (
        $(#[$doc:meta])*
        $name:ident { $($field:ident $($column:literal)?: $kind:ty, $unit:literal, $meaning:literal;)* }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $name {
            $(#[doc = concat!($meaning, ".")] pub $field: $kind,)*
        }

        impl $crate::columns::Cells for $name {
            fn header(&self) -> Vec<String> {
                use $crate::columns::Cell;
                [$(self.$field.names(row!(@name $field $($column)?))),*].concat()
            }

            fn cells(&self) -> Vec<String> {
                use $crate::columns::Cell;
                [$(self.$field.cells()),*].concat()
            }
        }

        impl $crate::columns::Row for $name {
            const COLUMNS: &'static [$crate::columns::Column] =
                &[$($crate::columns::Column::new(row!(@name $field $($column)?), $unit, $meaning)),*];
            const TEXTS: &'static [bool] = &[$(<$kind as $crate::columns::Cell>::IS_TEXT),*];

            fn numbers(&self) -> Vec<f64> {
                use $crate::columns::Cell;
                vec![$(self.$field.number()),*]
            }

            fn unknown() -> Self {
                Self { $($field: <$kind as $crate::columns::Cell>::unknown()),* }
            }

            fn read<'t>(
                mut cell: impl FnMut(usize) -> &'t str,
            ) -> Result<Self, &'static $crate::columns::Column> {
                let mut row = Self::unknown();
                let mut places = Self::COLUMNS.iter().enumerate();
                $(if let Some((k, column)) = places.next()
                    && let text = cell(k)
                    && !text.is_empty()
                {
                    row.$field = $crate::columns::Cell::read(text).ok_or(column)?;
                })*
                Ok(row)
            }
        }
    };
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $column:literal) => { $column };
}
pub(crate) use row;
