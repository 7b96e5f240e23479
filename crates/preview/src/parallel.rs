//! Loops that may run on several threads (feature `parallel`) and give the same result on any number of them: each
//! call of the body writes only its own part.

/// Calls `body(number, chunk)` for consecutive chunks of `size` elements.
pub(crate) fn chunks<T: Send>(
    data: &mut [T],
    size: usize,
    body: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    let size = size.max(1);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        data.par_chunks_mut(size)
            .enumerate()
            .for_each(|(number, chunk)| body(number, chunk));
    }
    #[cfg(not(feature = "parallel"))]
    for (number, chunk) in data.chunks_mut(size).enumerate() {
        body(number, chunk);
    }
}
