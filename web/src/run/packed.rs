//! Long lists cross from worker to page as one block of bytes: a million points as objects of JavaScript
//! would take seconds.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};

/// Something that is a fixed count of numbers. Single precision is more than a screen shows; the files
/// that are saved have every digit.
pub(crate) trait Packed: Sized {
    /// How many numbers.
    const COUNT: usize;
    /// Adds the numbers to a list.
    fn pack(&self, numbers: &mut Vec<f32>);
    /// Makes it of its numbers.
    fn unpack(numbers: &[f32]) -> Self;
}

pub(super) fn serialize<T: Packed, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    let mut numbers = Vec::with_capacity(list.len() * T::COUNT);
    for item in list {
        item.pack(&mut numbers);
    }
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    to.serialize_bytes(&bytes)
}

pub(super) fn deserialize<'de, T: Packed, D: Deserializer<'de>>(
    from: D,
) -> Result<Vec<T>, D::Error> {
    from.deserialize_byte_buf(Unpack(PhantomData))
}

struct Unpack<T>(PhantomData<T>);

impl<T: Packed> Visitor<'_> for Unpack<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a block of {} numbers at a time", T::COUNT)
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<T>, E> {
        let (words, _) = bytes.as_chunks::<4>();
        let numbers: Vec<f32> = words.iter().map(|word| f32::from_le_bytes(*word)).collect();
        Ok(numbers.chunks_exact(T::COUNT).map(T::unpack).collect())
    }
}
