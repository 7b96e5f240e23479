//! A file written again with some of its numbers replaced.

use crate::{WriteError, WriteReport};
use std::io::Write;

/// Bytes gathered before they are written.
const BUFFER: usize = 1 << 20;

/// Copies `bytes` to `out`, replacing parts of it in order.
pub(crate) struct Patch<'a> {
    bytes: &'a [u8],
    copied: usize,
    buffer: Vec<u8>,
    out: &'a mut dyn Write,
    written: u64,
}

impl<'a> Patch<'a> {
    pub(crate) fn new(bytes: &'a [u8], out: &'a mut dyn Write) -> Self {
        Self {
            bytes,
            copied: 0,
            buffer: Vec::new(),
            out,
            written: 0,
        }
    }

    /// Leaves out `bytes[from..to]`; what is pushed to the result next stands in its place.
    pub(crate) fn replace(&mut self, from: usize, to: usize) -> Result<&mut Vec<u8>, WriteError> {
        let kept = &self.bytes[self.copied..from];
        if self.buffer.len() + kept.len() > BUFFER {
            self.flush()?;
        }
        if kept.len() > BUFFER {
            self.out.write_all(kept)?;
            self.written += kept.len() as u64;
        } else {
            self.buffer.extend_from_slice(kept);
        }
        self.copied = to;
        Ok(&mut self.buffer)
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        self.out.write_all(&self.buffer)?;
        self.written += self.buffer.len() as u64;
        self.buffer.clear();
        Ok(())
    }

    /// Copies the rest, and adds the bytes written to the report.
    pub(crate) fn finish(mut self, report: &mut WriteReport) -> Result<(), WriteError> {
        let end = self.bytes.len();
        self.replace(end, end)?;
        self.flush()?;
        report.bytes += self.written;
        Ok(())
    }
}

/// Writes what has gathered in a buffer, once it is much.
pub(crate) fn flush(buffer: &mut Vec<u8>, out: &mut dyn Write) -> Result<(), WriteError> {
    if buffer.len() > BUFFER {
        out.write_all(buffer)?;
        buffer.clear();
    }
    Ok(())
}
