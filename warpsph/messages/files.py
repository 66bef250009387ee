"""Files and folders that cannot be read or written: which one, why, what to do."""
