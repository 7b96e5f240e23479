//! Loops that may run on several threads (feature `parallel`) and give the same result on any number of them: each
//! call of the body writes only its own part.

/// Calls `body(number, chunk)` for consecutive chunks of `size` elements.
pub fn chunks<T: Send>(data: &mut [T], size: usize, body: impl Fn(usize, &mut [T]) + Sync + Send) {
    chunks_with(data, size, || (), |(), number, chunk| body(number, chunk));
}

/// As [`chunks`], with scratch space that is made a few times and handed from call to call. A body must not depend on what
/// an earlier one has left there.
pub fn chunks_with<T: Send, W>(
    data: &mut [T],
    size: usize,
    scratch: impl Fn() -> W + Sync + Send,
    body: impl Fn(&mut W, usize, &mut [T]) + Sync + Send,
) {
    let size = size.max(1);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        data.par_chunks_mut(size)
            .enumerate()
            .for_each_init(scratch, |work, (number, chunk)| body(work, number, chunk));
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut work = scratch();
        for (number, chunk) in data.chunks_mut(size).enumerate() {
            body(&mut work, number, chunk);
        }
    }
}
