"""What a user is told when something is wrong: one file for each kind, one function for each message.

A function gives the exception, to be raised where the trouble is found. Its text is one line that says what happened,
where, and what to do.

- `values`: a value from a user that is not allowed;
- `bodies`: a body of a scene that cannot be;
- `scripts`: a scene file that cannot be used;
- `files`: a file that cannot be read;
- `output`: output that cannot be written;
- `restarts`: a run that cannot be gone on with;
- `remarks`: what is said of a run that goes on all the same;
- `stops`: a run that cannot go on, or that was ended;
- `machine`: a device, memory or a library that is not there;
- `measuring`: a benchmark that cannot be made.
"""
