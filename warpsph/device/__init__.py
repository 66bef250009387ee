"""The device: launches of kernels, alone or as a whole step, on a GPU or on threads of a CPU."""
