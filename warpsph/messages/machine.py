"""Devices, memory and libraries that a run asks for in vain: what is there, and what would do."""

from warpsph.errors import InputError, RunError


def no_package(what: str, package: str, extra: str) -> InputError:
    """Something needs a package that is not installed."""
    return InputError(f'{what} needs the package {package}; install it with: pip install "warpsph[{extra}]"')


def no_drawing() -> RunError:
    """There is no OpenGL."""
    return RunError(
        "this machine cannot draw off screen: OpenGL is missing; install Mesa (apt install libegl1)"
    )
