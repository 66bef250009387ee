"""Fixtures every test may use: specialisations, rounding units, devices."""

import pytest
import warp as wp

from warpsph.kernels.spec import Spec

wp.config.launch_array_access_mode = wp.config.LaunchArrayAccessMode.STRICT  # the default checks no devices

REALS = (wp.float32, wp.float64)


@pytest.fixture(params=[Spec(dim, real) for dim in (1, 2, 3) for real in REALS], ids=lambda s: s.tag)
def spec(request):
    """Every dimension in every precision."""
    return request.param


@pytest.fixture(params=[Spec(3, real) for real in REALS], ids=lambda s: s.tag)
def precision(request):
    """Every precision, for code that does not know the dimension."""
    return request.param


@pytest.fixture
def eps(request):
    """Rounding unit of the test's ``spec`` or ``precision``, to scale tolerances with."""
    name = "spec" if "spec" in request.fixturenames else "precision"
    return {wp.float32: 1.2e-7, wp.float64: 2.2e-16}[request.getfixturevalue(name).real]


def _devices():
    cuda = [str(device) for device in wp.get_cuda_devices()] or ["cuda:0"]
    return ["cpu", *(pytest.param(name, marks=pytest.mark.gpu) for name in cuda)]


@pytest.fixture(scope="session", params=_devices())
def device(request):
    """Every device; the CUDA one skips where there is none."""
    if request.param != "cpu" and not wp.is_cuda_available():
        pytest.skip("this machine has no CUDA device")
    with wp.ScopedDevice(request.param) as device:
        yield device
