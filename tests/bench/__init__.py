"""Benchmarks: chainbuild and its peers on the same targets in one run."""
