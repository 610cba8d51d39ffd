//! Aligned reading and writing of CDR.

/// Encapsulation header of plain CDR, little endian.
pub(crate) const HEADER: [u8; 4] = [0, 1, 0, 0];

pub(crate) struct Cursor<'a> {
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

/// A type that CDR has as this many bytes.
pub(crate) trait Fixed: Copy {
    const SIZE: usize;
    fn from(bytes: &[u8], big_endian: bool) -> Self;
    /// Appends the bytes in little endian.
    fn append(self, to: &mut Vec<u8>);
}

macro_rules! fixed {
    ($($t:ty),*) => {$(
        impl Fixed for $t {
            const SIZE: usize = size_of::<$t>();

            #[inline]
            fn from(bytes: &[u8], big_endian: bool) -> Self {
                let mut exact = [0; size_of::<$t>()];
                exact.copy_from_slice(bytes);
                if big_endian { Self::from_be_bytes(exact) } else { Self::from_le_bytes(exact) }
            }

            #[inline]
            fn append(self, to: &mut Vec<u8>) {
                to.extend(self.to_le_bytes());
            }
        }
    )*};
}
fixed!(i8, u8, i16, u16, i32, u32, i64, u64, f32, f64);

impl Fixed for bool {
    const SIZE: usize = 1;

    #[inline]
    fn from(bytes: &[u8], _: bool) -> Self {
        bytes[0] != 0
    }

    #[inline]
    fn append(self, to: &mut Vec<u8>) {
        to.push(self.into());
    }
}

/// Appends values in little endian, aligned to their size from the end of the header.
pub(crate) fn put<T: Fixed>(values: &[T], to: &mut Vec<u8>) {
    if !values.is_empty() {
        to.resize(HEADER.len() + (to.len() - HEADER.len()).next_multiple_of(T::SIZE), 0);
        values.iter().for_each(|value| value.append(to));
    }
}

impl<'a> Cursor<'a> {
    /// `body` is what follows the encapsulation header; alignment is counted from its start.
    pub(crate) fn new(body: &'a [u8], big_endian: bool) -> Self {
        Self { body, at: 0, big_endian }
    }

    pub(crate) fn left(&self) -> usize {
        self.body.len() - self.at
    }

    pub(crate) fn require(&self, bytes: u64) -> Result<(), String> {
        let (at, left) = (self.at, self.left());
        if bytes <= left as u64 {
            return Ok(());
        }
        Err(format!(
            "at byte {at} needs {bytes} bytes or more, and {left} are left (truncated, or another type)"
        ))
    }

    fn align(&mut self, size: usize) {
        let over = self.at % size;
        if over != 0 {
            self.at = (self.at + size - over).min(self.body.len());
        }
    }

    pub(crate) fn bytes(&mut self, count: usize) -> Result<&'a [u8], String> {
        self.require(count as u64)?;
        let bytes = &self.body[self.at..self.at + count];
        self.at += count;
        Ok(bytes)
    }

    #[inline]
    pub(crate) fn one<T: Fixed>(&mut self) -> Result<T, String> {
        self.align(T::SIZE);
        let big_endian = self.big_endian;
        Ok(T::from(self.bytes(T::SIZE)?, big_endian))
    }

    pub(crate) fn many<T: Fixed>(&mut self, count: usize) -> Result<Vec<T>, String> {
        // An empty array has no padding behind its length.
        if count == 0 {
            return Ok(Vec::new());
        }
        self.align(T::SIZE);
        self.require((count as u64).saturating_mul(T::SIZE as u64))?;
        let bytes = self.bytes(count * T::SIZE)?;
        // Two loops: the compiler makes a copy of the one without a swap of bytes.
        Ok(if self.big_endian {
            bytes.chunks_exact(T::SIZE).map(|b| T::from(b, true)).collect()
        } else {
            bytes.chunks_exact(T::SIZE).map(|b| T::from(b, false)).collect()
        })
    }
}
