"""What a run writes and reads back: snapshots, checkpoints and the history."""
