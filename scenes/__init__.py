"""Bundled scenes, one file each. Installed as ``warpsph.scenes``; run one with ``warpsph run NAME``."""
