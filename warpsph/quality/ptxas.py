"""NVIDIA's assembler: what a kernel takes of a multiprocessor, as ``ptxas -v`` tells it. Needs no GPU."""

import os
import re
import shutil
import site
import subprocess
from dataclasses import dataclass
from pathlib import Path

from warpsph.messages import measuring

_ENTRY = re.compile(r"Compiling entry function '(\w+)'")
_OWNER = re.compile(r"Function properties for (\w+)")
_FRAME = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
_USED = re.compile(r"Used (\d+) registers")
_CUMULATIVE = re.compile(r"(\d+) bytes cumulative stack size")
_SHARED = re.compile(r"(\d+) bytes smem")
_UNSUPPORTED = re.compile(r"Unsupported \.version [\d.]+; current version is '(\d+)\.(\d+)'")
_VERSION = re.compile(rb"^\.version (\d+)\.(\d+)", re.MULTILINE)


@dataclass(frozen=True)
class Usage:
    """What one kernel takes.

    Attributes:
        registers: Registers of a thread, 32 bits each.
        stack: Local memory of a thread [B]: spills, and arrays that are indexed at run time.
        stores: Bytes of instructions that spill a register to local memory.
        loads: Bytes of instructions that fetch a spilled one.
        shared: Static shared memory of a block [B].
    """

    registers: int
    stack: int = 0
    stores: int = 0
    loads: int = 0
    shared: int = 0

    @property
    def spilled(self) -> bool:
        """Whether registers went to local memory."""
        return self.stores > 0 or self.loads > 0


@dataclass(frozen=True)
class Assembler:
    """A ptxas.

    Attributes:
        path: Where it is.
        release: Its version.
        reads: Newest version of PTX that it reads; None if it does not say.
    """

    path: Path
    release: str
    reads: tuple[int, int] | None

    def __str__(self) -> str:
        """Version, and what it reads."""
        return self.release + (f" (reads PTX {self.reads[0]}.{self.reads[1]})" if self.reads else "")

    def assemble(self, ptx: Path, arch: int) -> dict[str, Usage]:
        """Assemble a file of PTX for ``sm_<arch>`` and throw the result away; gives the usage of each kernel by name.

        Raises:
            RunError: If ptxas refuses it.
        """
        done = _run(self.path, self.text(ptx), "-v", f"-arch=sm_{arch}")
        if done.returncode != 0:
            raise measuring.ptxas_refused(self, ptx.name, arch, done.stderr.strip())
        return parse(done.stderr)

    def text(self, ptx: Path) -> bytes:
        """What ptxas is given of a file: without the zero byte at its end, and a version of PTX that it reads.

        A ptxas older than Warp's compiler refuses its files by their version alone, before it has read an instruction.
        """
        text = ptx.read_bytes().rstrip(b"\0")
        if not self.outdated(text):
            return text
        return _VERSION.sub(b".version %d.%d" % self.reads, text, count=1)

    def outdated(self, text: bytes) -> bool:
        """Whether the text is of a newer version of PTX than this ptxas reads."""
        found = _VERSION.search(text)
        return bool(found and self.reads and tuple(map(int, found.groups())) > self.reads)


def find() -> Assembler | None:
    """Find a ptxas: NVIDIA's Python package ``nvidia-cuda-nvcc``, PATH, or a CUDA toolkit; None if there is none."""
    packages = [path for root in site.getsitepackages() for path in Path(root).glob("nvidia/*/bin/ptxas")]
    toolkits = [
        Path(root) / "bin" / "ptxas" for root in (os.environ.get("CUDA_HOME"), "/usr/local/cuda") if root
    ]
    on_path = [Path(path) for path in (shutil.which("ptxas"),) if path]
    for path in (*packages, *on_path, *toolkits):
        if os.access(path, os.X_OK):
            return _describe(path)
    return None


def parse(log: str) -> dict[str, Usage]:
    """Read what ``ptxas -v`` writes; gives the usage of each kernel by name.

    A function that was not inlined has its own line, which does not say who calls it: its spills are counted for every
    kernel of the file. ptxas itself adds its frame to the stack of those that call it.
    """
    name, frames, used = "", {}, {}
    for line in log.splitlines():
        if match := _ENTRY.search(line) or _OWNER.search(line):
            name = match[1]
        elif match := _FRAME.search(line):
            frames[name] = tuple(map(int, match.groups()))
        elif match := _USED.search(line):
            used[name] = int(match[1]), _number(_CUMULATIVE, line), _number(_SHARED, line)
    called = [frame for owner, frame in frames.items() if owner not in used]
    return {
        kernel: Usage(
            registers,
            stack=max(frames[kernel][0], cumulative),
            stores=frames[kernel][1] + sum(stores for _, stores, _ in called),
            loads=frames[kernel][2] + sum(loads for _, _, loads in called),
            shared=shared,
        )
        for kernel, (registers, cumulative, shared) in used.items()
    }


def _number(pattern: re.Pattern, line: str) -> int:
    """First group of a pattern in a line; 0 where it does not occur."""
    match = pattern.search(line)
    return int(match[1]) if match else 0


def _describe(path: Path) -> Assembler:
    """Ask a ptxas for its version, and for that of the PTX it reads: it names it when it refuses one."""
    release = re.search(r"V(\d+(?:\.\d+)+)", _run(path, b"", "--version").stdout)
    refusal = _UNSUPPORTED.search(_run(path, b".version 99.0\n.target sm_80\n").stderr)
    return Assembler(
        path,
        release[1] if release else "of unknown version",
        tuple(map(int, refusal.groups())) if refusal else None,
    )


def _run(path: Path, ptx: bytes, *options: str) -> subprocess.CompletedProcess:
    """Run ptxas on a text."""
    command = [str(path), *options, "-", "-o", os.devnull]
    done = subprocess.run(command, input=ptx, capture_output=True, check=False)
    return subprocess.CompletedProcess(
        command, done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")
    )
