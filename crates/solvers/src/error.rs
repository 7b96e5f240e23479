//! What is wrong with a system of equations.
//!
//! *Source*: a decision (2025): rows and columns are named as the caller numbers them, never as the solver orders them.

/// Why a system is not solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// An entry outside the matrix.
    #[error("entry {entry} is at row {row} and column {column} of a matrix of {size} rows")]
    OutOfRange {
        /// Number of the entry in its list.
        entry: usize,
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// Rows of the matrix.
        size: usize,
    },
    /// A list of the wrong length.
    #[error("{what}: {found} numbers where there should be {expected}")]
    Count {
        /// Which list.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// More rows or entries than can be numbered.
    #[error("{rows} rows and {entries} entries are more than can be numbered; split the system")]
    TooLarge {
        /// Rows.
        rows: usize,
        /// Entries.
        entries: usize,
    },
    /// A factor larger than allowed, or than memory.
    #[error("the factor has {entries} entries, and {most} are allowed; make the matrix sparser")]
    TooDense {
        /// Entries of the factor, rounded.
        entries: usize,
        /// How many are allowed.
        most: usize,
    },
    /// Not enough memory.
    #[error("there is not enough memory for the factor; make the matrix sparser")]
    OutOfMemory,
    /// A value that is not finite.
    #[error("the matrix has a value that is not finite at row {row}, column {column}")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// A matrix that is not positive definite to the digits there are.
    #[error("the matrix is not positive definite: nothing is left of row {row}")]
    NotPositiveDefinite {
        /// A row that depends on others, or that has a negative square.
        row: usize,
    },
    /// A right side or a solution that is not finite.
    #[error("the {what} has a number that is not finite at row {row}")]
    NoSolution {
        /// `right side` or `solution`.
        what: &'static str,
        /// Where.
        row: usize,
    },
}
