"""How good and how fast: benchmarks against peers, validation against published figures."""
