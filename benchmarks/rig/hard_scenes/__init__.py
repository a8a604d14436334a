"""Simulated scenes under conditions that are harder than those of the demo: for benchmarks, and their tests."""
