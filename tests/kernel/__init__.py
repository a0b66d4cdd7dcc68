"""Tests of the kernel, through its C interface."""
