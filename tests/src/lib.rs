//! Shared by the tests and benchmarks: worked cases, random numbers, models made in code.
