//! Columns of whole numbers in few bytes.

/// Why columns cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum ColumnError {
    #[error("it ends too early")]
    Short,
    #[error("there is more than it should hold")]
    Long,
    #[error("a number in it is too large")]
    Large,
}

/// Columns on their way into bytes: small numbers of either sign take one byte, which deflate makes less of.
#[derive(Default)]
pub(super) struct Columns {
    bytes: Vec<u8>,
}

impl Columns {
    pub(super) fn number(&mut self, value: i64) {
        let zigzag = ((value << 1) ^ (value >> 63)) as u64;
        varint(zigzag, &mut self.bytes);
    }

    /// A column, each number as the difference from what is expected of it. Places along a scan line run on
    /// evenly, standard deviations only scatter: the expectation that leaves least is taken, and named first.
    pub(super) fn rows(&mut self, values: &[i64], rows: &[usize]) {
        let candidates = EXPECTATIONS.map(|order| differences(values, rows, order));
        let cost = |differences: &[i64]| -> u64 {
            let bits = |d: &i64| u64::from(64 - d.unsigned_abs().leading_zeros());
            differences.iter().map(bits).sum()
        };
        let cheapest = (0..candidates.len()).min_by_key(|order| cost(&candidates[*order]));
        let cheapest = cheapest.unwrap_or(0);
        self.number(cheapest as i64);
        for difference in &candidates[cheapest] {
            self.number(*difference);
        }
    }

    /// The bytes, behind a head.
    pub(super) fn behind(&self, head: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(head.len() + self.bytes.len() + 4);
        varint(head.len() as u64, &mut bytes);
        bytes.extend(head);
        bytes.extend(&self.bytes);
        bytes
    }
}

fn differences(values: &[i64], rows: &[usize], order: Order) -> Vec<i64> {
    let mut expected = Expectation::new(order);
    let points = values.iter().zip(rows);
    let difference = |(value, row): (&i64, &usize)| {
        let difference = value.wrapping_sub(expected.of(*row));
        expected.learn(*row, *value);
        difference
    };
    points.map(difference).collect()
}

fn varint(mut value: u64, bytes: &mut Vec<u8>) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Columns on their way out of bytes that may be anything.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
}

/// The head of a payload, and the columns behind it.
pub(super) fn split(payload: &[u8]) -> Result<(&[u8], Reader<'_>), ColumnError> {
    let mut reader = Reader { bytes: payload };
    let length = usize::try_from(reader.varint()?).map_err(|_| ColumnError::Large)?;
    let (head, columns) = reader
        .bytes
        .split_at_checked(length)
        .ok_or(ColumnError::Short)?;
    Ok((head, Reader { bytes: columns }))
}

impl Reader<'_> {
    fn varint(&mut self) -> Result<u64, ColumnError> {
        let mut value = 0;
        for shift in (0..).step_by(7) {
            let (byte, rest) = self.bytes.split_first().ok_or(ColumnError::Short)?;
            self.bytes = rest;
            if shift > 56 {
                return Err(ColumnError::Large);
            }
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                break;
            }
        }
        Ok(value)
    }

    pub(super) fn number(&mut self) -> Result<i64, ColumnError> {
        let zigzag = self.varint()?;
        Ok((zigzag >> 1) as i64 ^ -((zigzag & 1) as i64))
    }

    /// As many numbers as there are rows' entries. Every number takes a byte at least, so a claim that
    /// exceeds the bytes is refused before anything is reserved.
    pub(super) fn rows(&mut self, rows: &[usize]) -> Result<Vec<i64>, ColumnError> {
        if rows.len() > self.bytes.len() {
            return Err(ColumnError::Short);
        }
        let order = usize::try_from(self.number()?).ok();
        let order = order.and_then(|order| EXPECTATIONS.get(order));
        let mut expected = Expectation::new(*order.ok_or(ColumnError::Large)?);
        let mut values = Vec::with_capacity(rows.len());
        for row in rows {
            let value = self.number()?.wrapping_add(expected.of(*row));
            expected.learn(*row, value);
            values.push(value);
        }
        Ok(values)
    }

    /// How many bytes are left: no more things than that can follow.
    pub(super) fn left(&self) -> usize {
        self.bytes.len()
    }

    pub(super) fn end(&self) -> Result<(), ColumnError> {
        if self.bytes.is_empty() {
            Ok(())
        } else {
            Err(ColumnError::Long)
        }
    }
}

/// How the next number is expected. Their places in this list are the format.
const EXPECTATIONS: [Order; 3] = [Order::First, Order::Last, Order::Even];

#[derive(Clone, Copy)]
enum Order {
    /// As the first number of all.
    First,
    /// As the last one; the first of a row as the first of the row before.
    Last,
    /// As far from the last as that from the one before; the second of a row as far from the first as in the
    /// row before.
    Even,
}

/// What the numbers so far let one expect of the next.
struct Expectation {
    order: Order,
    first: i64,
    row: Option<usize>,
    /// The first two numbers of the row before, as far as there were.
    before: Vec<i64>,
    /// The first two of this row.
    begin: Vec<i64>,
    /// The last two of this row, the last one first.
    last: [i64; 2],
}

impl Expectation {
    fn new(order: Order) -> Self {
        Self {
            order,
            first: 0,
            row: None,
            before: Vec::new(),
            begin: Vec::new(),
            last: [0; 2],
        }
    }

    fn of(&self, row: usize) -> i64 {
        if let Order::First = self.order {
            return self.first;
        }
        let goes_on = self.row == Some(row);
        let step = |from: i64, to: i64| match self.order {
            Order::Even => to.wrapping_sub(from),
            _ => 0,
        };
        let [last, earlier] = self.last;
        match (goes_on, self.begin.len(), self.before.as_slice()) {
            (false, 0, _) => 0,
            (false, ..) => self.begin[0],
            (true, 1, [from, to]) => last.wrapping_add(step(*from, *to)),
            (true, 1, _) => last,
            (true, ..) => last.wrapping_add(step(earlier, last)),
        }
    }

    fn learn(&mut self, row: usize, value: i64) {
        if self.row.is_none() {
            self.first = value;
        }
        if self.row != Some(row) {
            self.row = Some(row);
            self.before = std::mem::take(&mut self.begin);
        }
        if self.begin.len() < 2 {
            self.begin.push(value);
        }
        self.last = [value, self.last[0]];
    }
}
