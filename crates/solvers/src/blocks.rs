//! Cholesky's factor by dense blocks of plain arithmetic: the same digits on every processor, at several times the speed of single entries.
//!
//! Columns of the factor that have the same rows are one block, and small ones are joined to it where that adds few zeros. A block takes from all earlier
//! ones that reach it products of dense matrices, each entry a sum in the order of the columns; vectors of the processor hold rows, so that their
//! length changes no sum.
//!
//! *Source*: J. W. H. Liu, E. G. Ng, B. W. Peyton, *On Finding Supernodes for Sparse Matrix Computations*, 1993; Y. Chen, T. A. Davis, W. W. Hager,
//! S. Rajamanickam, *Algorithm 887: CHOLMOD*, 2008, for the left-looking factor and the joining of blocks; J. W. H. Liu, *The Role of
//! Elimination Trees in Sparse Factorization*, 1990.

use crate::pattern::Pattern;

const NONE: usize = usize::MAX;

/// What the pattern says: blocks of columns with their rows.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    /// The row of the matrix that stands at each place of the factor.
    order: Vec<u32>,
    /// The first column of each block, and the end.
    first: Vec<u32>,
    /// Where the rows of each block begin, its own columns first, and the end.
    row_starts: Vec<usize>,
    rows: Vec<u32>,
    /// Where the values of each block begin, column by column, and the end.
    value_starts: Vec<usize>,
    /// The block of each column.
    block_of: Vec<u32>,
    /// Where each entry of the pattern goes.
    entries: Vec<usize>,
    /// Room for the largest product.
    largest: usize,
}

/// Room for a factor and its solutions.
#[derive(Debug, Default)]
pub(crate) struct BlockRoom {
    product: Vec<f64>,
    /// Of each row: its number within the block at hand.
    local: Vec<u32>,
    /// Of each block: the next one that reaches the same block, and the row that it reaches it by.
    next: Vec<usize>,
    head: Vec<usize>,
    reach: Vec<usize>,
    right: Vec<f64>,
    /// Of the rows of a block.
    gathered: Vec<f64>,
}

// Rows and entries of patterns fit 31 bits.
#[allow(clippy::cast_possible_truncation)]
fn narrow(number: usize) -> u32 {
    number as u32
}

/// The column of the next entry of every column of the factor, `NONE` at roots.
fn elimination_tree(size: usize, starts: &[usize], columns: &[u32]) -> Vec<usize> {
    let mut parent = vec![NONE; size];
    let mut ancestor = vec![NONE; size];
    for row in 0..size {
        for &column in &columns[starts[row]..starts[row + 1]] {
            let mut node = column as usize;
            while node != NONE && node < row {
                let above = ancestor[node];
                ancestor[node] = row;
                if above == NONE {
                    parent[node] = row;
                }
                node = above;
            }
        }
    }
    parent
}

/// The nodes of a forest, each behind all below it.
fn postorder(parent: &[usize]) -> Vec<usize> {
    let size = parent.len();
    let (mut child, mut sibling) = (vec![NONE; size], vec![NONE; size]);
    for node in (0..size).rev() {
        if parent[node] != NONE {
            sibling[node] = child[parent[node]];
            child[parent[node]] = node;
        }
    }
    let mut order = Vec::with_capacity(size);
    let mut stack = Vec::new();
    for root in (0..size).filter(|&node| parent[node] == NONE) {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let next = child[node];
            if next == NONE {
                order.push(node);
                stack.pop();
            } else {
                child[node] = sibling[next];
                stack.push(next);
            }
        }
    }
    order
}

/// Entries left of the diagonal, row by row, in an order of the rows given by their places.
fn by_rows(pattern: &Pattern, place: &[u32]) -> (Vec<usize>, Vec<u32>) {
    let size = pattern.size();
    let mut starts = vec![0; size + 1];
    let pair = |(column, row): (usize, usize)| {
        let (a, b) = (place[column], place[row]);
        (a.min(b), a.max(b))
    };
    for entry in pattern.entries() {
        let (low, high) = pair(entry);
        starts[high as usize + 1] += usize::from(low != high);
    }
    for row in 0..size {
        starts[row + 1] += starts[row];
    }
    let mut columns = vec![0; starts[size]];
    let mut filled = starts.clone();
    for entry in pattern.entries() {
        let (low, high) = pair(entry);
        if low != high {
            columns[filled[high as usize]] = low;
            filled[high as usize] += 1;
        }
    }
    (starts, columns)
}

/// How many entries each column of the factor has.
fn column_counts(parent: &[usize], starts: &[usize], columns: &[u32]) -> Vec<usize> {
    let size = parent.len();
    let mut counts = vec![1; size];
    let mut seen = vec![NONE; size];
    for row in 0..size {
        seen[row] = row;
        for &column in &columns[starts[row]..starts[row + 1]] {
            let mut node = column as usize;
            while node != NONE && seen[node] != row {
                counts[node] += 1;
                seen[node] = row;
                node = parent[node];
            }
        }
    }
    counts
}

/// First columns of blocks.
fn joined(parent: &[usize], counts: &[usize]) -> Vec<u32> {
    struct Block {
        first: usize,
        last: usize,
        rows: usize,
        zeros: usize,
    }
    let entries = |rows: usize, columns: usize| rows * columns - columns * (columns - 1) / 2;
    let size = parent.len();
    let mut blocks: Vec<Block> = Vec::new();
    let mut begin = 0;
    while begin < size {
        let mut end = begin;
        while parent[end] == end + 1 && counts[end] == counts[end + 1] + 1 {
            end += 1;
        }
        let mut block = Block {
            first: begin,
            last: end,
            rows: counts[begin],
            zeros: 0,
        };
        begin = end + 1;
        while let Some(child) = blocks.last() {
            let above = parent[child.last];
            if above == NONE || above > block.last {
                break;
            }
            let (few, more) = (child.last + 1 - child.first, block.last + 1 - block.first);
            let (columns, rows) = (few + more, few + block.rows);
            let whole = entries(rows, columns);
            let zeros = whole
                - (entries(child.rows, few) - child.zeros)
                - (entries(block.rows, more) - block.zeros);
            let share = zeros as f64 / whole as f64;
            let allowed = match columns {
                0..=4 => 0.8,
                5..=16 => 0.15,
                17..=48 => 0.06,
                _ => 0.02,
            };
            if share > allowed {
                break;
            }
            block = Block {
                first: child.first,
                last: block.last,
                rows,
                zeros,
            };
            blocks.pop();
        }
        blocks.push(block);
    }
    let firsts = blocks.iter().map(|block| narrow(block.first));
    firsts.chain([narrow(size)]).collect()
}

impl Blocks {
    /// The blocks of a pattern whose rows are to be taken in an order.
    pub(crate) fn of(pattern: &Pattern, order: &[u32]) -> Self {
        let size = pattern.size();
        let places = |order: &[u32]| {
            let mut place = vec![0; size];
            for (new, &old) in order.iter().enumerate() {
                place[old as usize] = narrow(new);
            }
            place
        };
        // In an order in which what reaches a column comes just before it.
        let (starts, columns) = by_rows(pattern, &places(order));
        let post = postorder(&elimination_tree(size, &starts, &columns));
        let order: Vec<u32> = post.iter().map(|&node| order[node]).collect();
        let place = places(&order);
        let (starts, columns) = by_rows(pattern, &place);
        let parent = elimination_tree(size, &starts, &columns);
        let counts = column_counts(&parent, &starts, &columns);
        let first = joined(&parent, &counts);
        let count = first.len() - 1;
        let mut block_of = vec![0; size];
        for block in 0..count {
            block_of[first[block] as usize..first[block + 1] as usize].fill(narrow(block));
        }
        // Rows: those of the matrix, and those of the blocks below in the tree.
        let mut below: Vec<Vec<u32>> = vec![Vec::new(); count];
        for row in 0..size {
            for &column in &columns[starts[row]..starts[row + 1]] {
                let block = block_of[column as usize];
                if block != block_of[row] {
                    below[block as usize].push(narrow(row));
                }
            }
        }
        let (mut row_starts, mut value_starts) = (vec![0], vec![0]);
        let mut rows: Vec<u32> = Vec::new();
        let mut largest = 0;
        for block in 0..count {
            let mut own = std::mem::take(&mut below[block]);
            own.sort_unstable();
            own.dedup();
            if let Some(&above) = own.first() {
                let above = block_of[above as usize] as usize;
                let end = first[above + 1];
                let further = own.iter().filter(|&&row| row >= end);
                below[above].extend(further);
            }
            rows.extend(first[block]..first[block + 1]);
            let columns = (first[block + 1] - first[block]) as usize;
            let height = columns + own.len();
            // Of what a block takes from this one at a time.
            for run in own.chunk_by(|a, b| block_of[*a as usize] == block_of[*b as usize]) {
                largest = largest.max(run.len() * own.len());
            }
            rows.append(&mut own);
            row_starts.push(rows.len());
            value_starts.push(value_starts[block] + height * columns);
        }
        let mut blocks = Self {
            order,
            first,
            row_starts,
            rows,
            value_starts,
            block_of,
            entries: Vec::with_capacity(pattern.len()),
            largest,
        };
        for (column, row) in pattern.entries() {
            let (a, b) = (place[column], place[row]);
            let at = blocks.place(a.max(b), a.min(b));
            blocks.entries.push(at);
        }
        blocks
    }

    /// Where an entry stands.
    fn place(&self, row: u32, column: u32) -> usize {
        let block = self.block_of[column as usize] as usize;
        let rows = &self.rows[self.row_starts[block]..self.row_starts[block + 1]];
        let local = rows.partition_point(|&r| r < row);
        let column = (column - self.first[block]) as usize;
        self.value_starts[block] + column * rows.len() + local
    }

    /// How many values a factor has.
    pub(crate) fn len(&self) -> usize {
        self.value_starts.last().copied().unwrap_or(0)
    }

    /// The most rows of a block.
    fn tallest(&self) -> usize {
        let pairs = self.row_starts.iter().zip(self.row_starts.iter().skip(1));
        pairs.map(|(from, to)| to - from).max().unwrap_or(0)
    }

    /// Room for the work on a factor.
    pub(crate) fn room(&self) -> BlockRoom {
        let (size, count) = (self.order.len(), self.first.len() - 1);
        BlockRoom {
            product: vec![0.0; self.largest],
            local: vec![0; size],
            next: vec![NONE; count],
            head: vec![NONE; count],
            reach: vec![0; count],
            right: vec![0.0; size],
            gathered: vec![0.0; self.tallest()],
        }
    }

    /// The factor of the matrix with these values of the pattern; the row of the matrix whose pivot is not positive, if there is one.
    pub(crate) fn factorize(
        &self,
        matrix: &[f64],
        values: &mut [f64],
        room: &mut BlockRoom,
    ) -> Result<(), usize> {
        values.fill(0.0);
        for (&at, &value) in self.entries.iter().zip(matrix) {
            values[at] = value;
        }
        room.head.fill(NONE);
        for block in 0..self.first.len() - 1 {
            let rows = &self.rows[self.row_starts[block]..self.row_starts[block + 1]];
            let (first, end) = (self.first[block], self.first[block + 1]);
            let columns = (end - first) as usize;
            let (before, rest) = values.split_at_mut(self.value_starts[block]);
            let panel = &mut rest[..rows.len() * columns];
            for (local, &row) in rows.iter().enumerate() {
                room.local[row as usize] = narrow(local);
            }
            let mut other = room.head[block];
            while other != NONE {
                let next = room.next[other];
                let their = &self.rows[self.row_starts[other]..self.row_starts[other + 1]];
                let from = room.reach[other];
                let width = their[from..].partition_point(|&row| row < end);
                let start = self.value_starts[other];
                let (height, depth) = (
                    their.len(),
                    (self.first[other + 1] - self.first[other]) as usize,
                );
                let theirs = &before[start..start + height * depth];
                let count = height - from;
                let product = &mut room.product[..count * width];
                multiply(theirs, height, from, width, product);
                for (column, list) in product.chunks_exact(count).enumerate() {
                    let at = room.local[their[from + column] as usize] as usize * rows.len();
                    let panel = &mut panel[at..at + rows.len()];
                    for (value, &row) in list[column..].iter().zip(&their[from + column..]) {
                        panel[room.local[row as usize] as usize] -= value;
                    }
                }
                room.reach[other] = from + width;
                if let Some(&row) = their.get(from + width) {
                    let to = self.block_of[row as usize] as usize;
                    room.next[other] = room.head[to];
                    room.head[to] = other;
                }
                other = next;
            }
            if let Err(column) = dense(panel, rows.len(), columns) {
                return Err(self.order[first as usize + column] as usize);
            }
            room.reach[block] = columns;
            if let Some(&row) = rows.get(columns) {
                let to = self.block_of[row as usize] as usize;
                room.next[block] = room.head[to];
                room.head[to] = block;
            }
        }
        Ok(())
    }

    /// The solution in place of the right side.
    pub(crate) fn solve(&self, values: &[f64], right: &mut [f64], room: &mut BlockRoom) {
        let x = &mut room.right;
        for (x, &row) in x.iter_mut().zip(&self.order) {
            *x = right[row as usize];
        }
        let count = self.first.len() - 1;
        for block in 0..count {
            let (rows, panel, first) = self.block(block, values);
            let columns = panel.len() / rows.len();
            let (own, below) = x[first..].split_at_mut(columns);
            let list = &mut room.gathered[..rows.len()];
            list.fill(0.0);
            for (column, entries) in panel.chunks_exact(rows.len()).enumerate() {
                let value = (own[column] - list[column]) / entries[column];
                own[column] = value;
                let after = list[column + 1..].iter_mut().zip(&entries[column + 1..]);
                for (sum, entry) in after {
                    *sum += entry * value;
                }
            }
            let end = first + columns;
            for (sum, &row) in list[columns..].iter().zip(&rows[columns..]) {
                below[row as usize - end] -= sum;
            }
        }
        for block in (0..count).rev() {
            let (rows, panel, first) = self.block(block, values);
            let list = &mut room.gathered[..rows.len()];
            for (value, &row) in list.iter_mut().zip(rows) {
                *value = x[row as usize];
            }
            for (column, entries) in panel.chunks_exact(rows.len()).enumerate().rev() {
                let rest = list[column] - dot(&entries[column + 1..], &list[column + 1..]);
                list[column] = rest / entries[column];
                x[first + column] = list[column];
            }
        }
        for (x, &row) in x.iter().zip(&self.order) {
            right[row as usize] = *x;
        }
    }

    fn block<'a>(&'a self, block: usize, values: &'a [f64]) -> (&'a [u32], &'a [f64], usize) {
        (
            &self.rows[self.row_starts[block]..self.row_starts[block + 1]],
            &values[self.value_starts[block]..self.value_starts[block + 1]],
            self.first[block] as usize,
        )
    }
}

/// Rows that are worked on together.
const RUN: usize = 8;

/// A scalar product, summed in as many lanes as are worked on together.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; RUN];
    let (mut first, mut second) = (a.chunks_exact(RUN), b.chunks_exact(RUN));
    for (a, b) in (&mut first).zip(&mut second) {
        for k in 0..RUN {
            lanes[k] += a[k] * b[k];
        }
    }
    let rest = first.remainder().iter().zip(second.remainder());
    let sum: f64 = lanes.iter().sum();
    rest.fold(sum, |sum, (a, b)| sum + a * b)
}

/// `A Bᵀ`, where `A` has the rows from `from` of a panel and `B` the first `width` of these; what is above the diagonal may be left out.
fn multiply(panel: &[f64], height: usize, from: usize, width: usize, product: &mut [f64]) {
    let count = height - from;
    let mut column = 0;
    while column < width {
        let two = column + 1 < width;
        let mut row = column;
        while row + RUN <= count {
            let (mut first, mut second) = ([0.0; RUN], [0.0; RUN]);
            for list in panel.chunks_exact(height) {
                let list = &list[from..];
                let b = list[column];
                let c = if two { list[column + 1] } else { 0.0 };
                if let Some(a) = list[row..].first_chunk::<RUN>() {
                    for k in 0..RUN {
                        first[k] += a[k] * b;
                        second[k] += a[k] * c;
                    }
                }
            }
            product[column * count + row..][..RUN].copy_from_slice(&first);
            if two {
                product[(column + 1) * count + row..][..RUN].copy_from_slice(&second);
            }
            row += RUN;
        }
        while row < count {
            let (mut first, mut second) = (0.0, 0.0);
            for list in panel.chunks_exact(height) {
                let list = &list[from..];
                first += list[row] * list[column];
                if two {
                    second += list[row] * list[column + 1];
                }
            }
            product[column * count + row] = first;
            if two {
                product[(column + 1) * count + row] = second;
            }
            row += 1;
        }
        column += 2;
    }
}

/// The factor of a panel whose first rows are its columns, in place; the column whose pivot is not positive.
fn dense(panel: &mut [f64], height: usize, columns: usize) -> Result<(), usize> {
    for column in 0..columns {
        let (before, rest) = panel.split_at_mut(column * height);
        let list = &mut rest[column..height];
        let mut each = before.chunks_exact(height);
        // Four at a time: fewer ways to memory and back.
        let mut four = before.chunks_exact(4 * height);
        for lists in &mut four {
            let (a, lists) = lists.split_at(height);
            let (b, lists) = lists.split_at(height);
            let (c, d) = lists.split_at(height);
            let (a, b, c, d) = (&a[column..], &b[column..], &c[column..], &d[column..]);
            let factors = [a[0], b[0], c[0], d[0]];
            let terms = a.iter().zip(b).zip(c).zip(d);
            for (value, (((a, b), c), d)) in list.iter_mut().zip(terms) {
                *value -= a * factors[0] + b * factors[1] + c * factors[2] + d * factors[3];
            }
            each.nth(3);
        }
        for a in each {
            let a = &a[column..];
            let factor = a[0];
            for (value, a) in list.iter_mut().zip(a) {
                *value -= a * factor;
            }
        }
        let pivot = list[0];
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(column);
        }
        let root = pivot.sqrt();
        list[0] = root;
        let inverse = 1.0 / root;
        for value in &mut list[1..] {
            *value *= inverse;
        }
    }
    Ok(())
}
