"""Devices, memory and libraries that a run asks for in vain: what is there, and what would do."""
