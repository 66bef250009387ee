"""What a user is told when something is wrong: one file for each kind, one function for each message.

A function gives the exception, to be raised where the trouble is found. Its text is one line that says what happened,
where, and what to do.

- `values`: a value from a user that is not allowed;
- `bodies`: a body of a scene that cannot be;
- `scripts`: a scene file that cannot be used;
- `files`: a file or folder that cannot be read or written;
- `machine`: a device, memory or a library that is not there;
- `stops`: a run that cannot go on, or that was ended;
- `measuring`: a benchmark that cannot be made;
- `remarks`: what is no exception, only said, while the run goes on.
"""
