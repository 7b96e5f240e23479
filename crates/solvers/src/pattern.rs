//! Which entries a symmetric sparse matrix may have.
//!
//! A pattern keeps the lower triangle by columns, rows ascending, with the whole diagonal. It remembers where each entry of the list it
//! was made from belongs, so that matrices of the same pattern are assembled without a search: contributions to one entry are summed in the
//! order of the list, which makes sums the same always.
//!
//! *Source*: T. A. Davis, *Direct Methods for Sparse Linear Systems*, SIAM 2006, §2.1–2.4.

use crate::SolverError;

/// The entries of a symmetric matrix that may differ from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    size: usize,
    /// Where columns start in `rows`, and the end of the last.
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// Where each entry of the list belongs.
    places: Vec<u32>,
}

impl Pattern {
    /// The pattern of a matrix of `size` rows with these entries, `(row, column)`, in any order. An entry and its mirror image are one, and
    /// may come more than once; the diagonal is always there.
    ///
    /// # Errors
    /// [`SolverError::OutOfRange`] for an entry outside the matrix, [`SolverError::TooLarge`] for more than 2³¹ rows or entries.
    pub fn of_entries(size: usize, entries: &[(usize, usize)]) -> Result<Self, SolverError> {
        let total = size.saturating_add(entries.len());
        let limit = i32::MAX as usize;
        if total > limit {
            return Err(SolverError::TooLarge {
                rows: size,
                entries: entries.len(),
            });
        }
        let outside = |&(row, column): &(usize, usize)| row >= size || column >= size;
        if let Some(entry) = entries.iter().position(outside) {
            let (row, column) = entries[entry];
            return Err(SolverError::OutOfRange {
                entry,
                row,
                column,
                size,
            });
        }
        // All fit 31 bits.
        #[allow(clippy::cast_possible_truncation)]
        let narrow = |number: usize| number as u32;
        let lower = |&(i, j): &(usize, usize)| (narrow(i.min(j)), narrow(i.max(j)));
        let mut sorted: Vec<(u32, u32, u32)> = Vec::with_capacity(total);
        for (number, entry) in entries.iter().enumerate() {
            let (column, row) = lower(entry);
            sorted.push((column, row, narrow(number)));
        }
        // Behind the list the diagonal.
        for i in 0..size {
            sorted.push((narrow(i), narrow(i), narrow(entries.len() + i)));
        }
        sorted.sort_unstable();
        let mut pattern = Self {
            size,
            starts: vec![0; size + 1],
            rows: Vec::new(),
            places: vec![0; entries.len()],
        };
        let mut last = None;
        for (column, row, number) in sorted {
            if last != Some((column, row)) {
                last = Some((column, row));
                pattern.rows.push(row);
                pattern.starts[column as usize + 1] = narrow(pattern.rows.len());
            }
            if let Some(place) = pattern.places.get_mut(number as usize) {
                *place = narrow(pattern.rows.len() - 1);
            }
        }
        Ok(pattern)
    }

    /// Rows of the matrix.
    pub fn size(&self) -> usize {
        self.size
    }
    /// Entries of the lower triangle, diagonal included: how many values a matrix of this pattern has.
    pub fn len(&self) -> usize {
        self.rows.len()
    }
    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.size == 0
    }
    /// Where columns start in [`Pattern::rows`], and the end of the last.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }
    /// Row numbers of the entries, column by column, ascending in each.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// The values of a matrix, in the order of [`Pattern::rows`], from a contribution for each entry of the list that the pattern was made
    /// from: those to one entry are summed in the order of the list. What the list gives nothing to is 0.
    ///
    /// # Errors
    /// [`SolverError::Count`] unless there is one contribution for each entry of the list.
    pub fn assemble(&self, contributions: &[f64]) -> Result<Vec<f64>, SolverError> {
        check_count("contributions", contributions, self.places.len())?;
        let mut values = vec![0.0; self.len()];
        for (&place, &contribution) in self.places.iter().zip(contributions) {
            values[place as usize] += contribution;
        }
        Ok(values)
    }

    /// Column and row of every entry, in order.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.size).flat_map(|column| {
            let range = self.starts[column] as usize..self.starts[column + 1] as usize;
            self.rows[range]
                .iter()
                .map(move |&row| (column, row as usize))
        })
    }

    /// `y = A x`, the matrix given by its values.
    ///
    /// # Errors
    /// [`SolverError::Count`] for lists of the wrong length.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) -> Result<(), SolverError> {
        check_count("values", values, self.len())?;
        check_count("factor", x, self.size)?;
        check_count("product", y, self.size)?;
        y.fill(0.0);
        for ((column, row), &value) in self.entries().zip(values) {
            y[row] += value * x[column];
            if row != column {
                y[column] += value * x[row];
            }
        }
        Ok(())
    }
}

/// Refuses a list of the wrong length.
pub(crate) fn check_count(
    what: &'static str,
    list: &[f64],
    expected: usize,
) -> Result<(), SolverError> {
    let found = list.len();
    if found == expected {
        Ok(())
    } else {
        Err(SolverError::Count {
            what,
            found,
            expected,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_sorted_merged_and_mirrored() {
        let entries = [(2, 0), (0, 2), (1, 2), (2, 0), (3, 3)];
        let pattern = Pattern::of_entries(4, &entries).unwrap();
        assert_eq!(pattern.starts(), [0, 2, 4, 5, 6]);
        assert_eq!(pattern.rows(), [0, 2, 1, 2, 2, 3]);
        let values = pattern.assemble(&[1.0, 2.0, 4.0, 8.0, 16.0]).unwrap();
        assert_eq!(values, [0.0, 11.0, 0.0, 4.0, 0.0, 16.0]);
        let mut y = [0.0; 4];
        pattern
            .multiply(&values, &[1.0, 2.0, 3.0, 4.0], &mut y)
            .unwrap();
        assert_eq!(y, [33.0, 12.0, 19.0, 64.0]);
    }

    #[test]
    fn wrong_lists_are_refused() {
        let error = Pattern::of_entries(2, &[(0, 0), (1, 2)]).unwrap_err();
        assert!(error.to_string().contains("entry 1"), "{error}");
        let pattern = Pattern::of_entries(2, &[(0, 1)]).unwrap();
        assert!(pattern.assemble(&[]).is_err());
        assert!(pattern.multiply(&[1.0; 3], &[1.0; 2], &mut [0.0]).is_err());
        assert!(Pattern::of_entries(0, &[]).unwrap().is_empty());
    }
}
