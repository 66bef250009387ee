"""Rules that a linter does not know, checked on the source."""

import ast
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = {
    "warpsph": ROOT / "warpsph",
    "warpsph.kernels": ROOT / "kernels",
    "warpsph.scenes": ROOT / "scenes",
}
KERNEL_FILES = sorted((ROOT / "kernels").glob("*.py"))
HOST_FILES = sorted((ROOT / "warpsph").rglob("*.py"))

KERNEL_LIBRARIES = {
    "collections",
    "dataclasses",
    "enum",
    "functools",
    "hashlib",
    "inspect",
    "math",
    "typing",
    "warp",
}
ENGINE = {"clock", "device", "memory", "particles", "schemes", "search"}
OUTPUT = {"drawing", "plot", "render", "scalars", "storage"}
TOP = {"cli", "library", "progress", "quality", "run", "running"}


def path_id(path):
    return str(path.relative_to(ROOT))


def imported(path):
    """Full names of the modules a file imports, at any depth."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                package = package_of(path).split(".")
                base = ".".join([*package[: len(package) - node.level + 1], *filter(None, [base])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def package_of(path):
    name, folder = next((n, f) for n, f in PACKAGES.items() if path.is_relative_to(f))
    return ".".join([name, *path.parent.relative_to(folder).parts])


def own_modules(path):
    """First names below ``warpsph`` that a file imports."""
    return {
        parts[1]
        for parts in (name.split(".") for name in imported(path))
        if parts[0] == "warpsph" and parts[1:]
    }


def decorated(path, kind):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef):
            for decorator in node.decorator_list:
                if ast.unparse(getattr(decorator, "func", decorator)) == f"wp.{kind}":
                    yield node


KERNELS = [
    pytest.param(kernel, id=f"{path.stem}-{kernel.name}")
    for path in KERNEL_FILES
    for kernel in decorated(path, "kernel")
]


def written(kernel):
    """Names of the parameters a kernel stores to, itself or by a function ``put`` or ``put_...``."""
    names = {a.arg for a in kernel.args.args}
    for node in ast.walk(kernel):
        targets = getattr(node, "targets", [getattr(node, "target", None)])
        stores = [ast.unparse(t.value) for t in targets if isinstance(t, ast.Subscript)]
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            if called in ("wp.atomic_min", "wp.atomic_max") or called.split("_")[0] == "put":
                stores.append(ast.unparse(node.args[0]))
        yield from (store for store in stores if store in names)


@pytest.mark.parametrize("path", KERNEL_FILES, ids=path_id)
def test_device_code_imports_no_host_code(path):
    for name in imported(path):
        assert name.startswith("warpsph.kernels") or name.split(".")[0] in KERNEL_LIBRARIES, (
            f"device code imports {name}"
        )


@pytest.mark.parametrize("path", KERNEL_FILES, ids=path_id)
def test_sums_are_gathered(path):
    calls = {ast.unparse(n.func) for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)}
    assert not calls & {"wp.atomic_add", "wp.atomic_sub"}, "the order of atomic sums is not repeatable"


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernel_says_what_it_computes(kernel):
    assert ast.get_docstring(kernel), "a kernel's docstring is its formula, unit and source"


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernel_runs_on_a_slice(kernel):
    first = kernel.args.args[0]
    assert (first.arg, ast.unparse(first.annotation)) == ("offset", "wp.int32"), (
        "the launcher slices launches"
    )
    source = ast.unparse(kernel)
    assert source.count("wp.tid()") == source.count("wp.tid() + offset"), (
        "a thread's index starts at the offset"
    )


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernel_outputs_come_last(kernel):
    names = [a.arg for a in kernel.args.args]
    outputs = set(written(kernel))
    assert outputs and set(names[-len(outputs) :]) == outputs


@pytest.mark.parametrize("kernel", KERNELS)
def test_kernel_adds_in_local_variables(kernel):
    names = {a.arg for a in kernel.args.args}
    for node in ast.walk(kernel):
        if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Subscript):
            assert ast.unparse(node.target.value) not in names, "a[i] += b is an atomic add in Warp"


@pytest.mark.parametrize("path", KERNEL_FILES, ids=path_id)
def test_device_code_does_no_arithmetic_on_literals(path):
    for code in (*decorated(path, "kernel"), *decorated(path, "func")):
        for node in ast.walk(code):
            operands = (getattr(node, "left", None), getattr(node, "right", None))
            assert not all(isinstance(o, ast.Constant) and isinstance(o.value, float) for o in operands), (
                f"Warp computes {ast.unparse(node)} in single precision: do it outside of the function"
            )


@pytest.mark.parametrize("path", HOST_FILES, ids=path_id)
def test_host_files_define_no_kernels(path):
    assert not list(decorated(path, "kernel")), "device code lives in kernels/"


@pytest.mark.parametrize("path", HOST_FILES, ids=path_id)
def test_layers(path):
    """The engine knows no files, output knows no schemes, and neither knows what sits on top."""
    layer = package_of(path).split(".")[1] if package_of(path) != "warpsph" else path.stem
    forbidden = {
        **dict.fromkeys(ENGINE, OUTPUT | TOP),
        **dict.fromkeys(OUTPUT, {"schemes", "solver"} | TOP),
        "solver": OUTPUT | TOP,
    }
    assert not own_modules(path) & forbidden.get(layer, set())


def test_layers_are_named_as_they_are():
    """A name that nothing has any more would forbid nothing."""
    assert {path.stem for path in (ROOT / "warpsph").iterdir()} >= ENGINE | OUTPUT | TOP


def test_every_package_is_listed():
    """Nothing can discover a mapped package: one that is not listed is missing in the wheel."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    found = {package_of(init) for folder in PACKAGES.values() for init in folder.rglob("__init__.py")}
    assert set(settings["packages"]) == found
    assert {name: ROOT / folder for name, folder in settings["package-dir"].items()} == {
        name: folder for name, folder in PACKAGES.items() if name != "warpsph"
    }
