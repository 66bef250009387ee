"""Particles drawn as lit spheres, off screen."""

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from warpsph.messages import machine

from .camera import ANGLE, Camera

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkRenderWindow


OSMESA = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")
"""Names of the library that draws in memory where there is no EGL."""


class Spheres:
    """An off-screen window that draws spheres of one size from a fixed camera.

    Each sphere is one ray-traced square (an impostor): a sphere of triangles looks the same and takes
    twenty times as long to prepare.
    """

    def __init__(self, size: tuple[int, int], radius: float, camera: Camera):
        """Open the window.

        Args:
            size: Width and height [pixels].
            radius: Radius of every sphere [m].
            camera: Where the picture is taken from.

        Raises:
            RunError: If this machine cannot draw off screen.
        """
        import pyvista
        from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLSphereMapper

        with pyvista.vtk_verbosity("off"):  # else VTK complains that there is no display, and goes on without
            self._plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
            _check(self._plotter.render_window)
        self._mapper = vtkOpenGLSphereMapper()
        self._mapper.SetRadius(radius)
        actor = pyvista.Actor(mapper=self._mapper)
        actor.prop.ambient, actor.prop.diffuse = 0.35, 0.75
        actor.prop.specular, actor.prop.specular_power = 0.15, 25.0
        self._plotter.set_background("white")
        self._plotter.add_actor(actor, reset_camera=False)
        self._plotter.enable_anti_aliasing("ssaa")
        self._aim(camera)

    def draw(self, x: np.ndarray, colours: np.ndarray) -> np.ndarray:
        """Draw one picture.

        Args:
            x: Centres [m], shape [n, 3].
            colours: Red, green, blue, shape [n, 3], uint8.

        Returns:
            The picture, shape [height, width, 3], uint8.
        """
        import pyvista

        cloud = pyvista.PolyData(x) if len(x) else pyvista.PolyData()
        if len(x):
            cloud["colours"] = colours
            cloud.set_active_scalars("colours")
        self._mapper.SetInputData(cloud)
        self._plotter.renderer.ResetCameraClippingRange()
        with pyvista.vtk_verbosity("off"):
            self._plotter.render()
            return np.asarray(self._plotter.screenshot(None, return_img=True))

    def close(self) -> None:
        """Give the window back."""
        self._plotter.close()

    def _aim(self, camera: Camera) -> None:
        """Set VTK's camera; its distances are in metres too."""
        view = self._plotter.camera
        view.position, view.focal_point, view.up = map(tuple, (camera.position, camera.focus, camera.up))
        view.view_angle = ANGLE
        view.parallel_projection = camera.parallel
        view.parallel_scale = camera.height / 2.0


def _check(window: "vtkRenderWindow") -> None:
    """Make sure that a window can draw: VTK itself would crash at the first picture, or before.

    Raises:
        RunError: If it cannot.
    """
    # VTK takes this class where neither EGL nor X is there; without its library it must not even be initialised
    if window.GetClassName() != "vtkOSOpenGLRenderWindow" or any(map(_loads, OSMESA)):
        window.Initialize()
        if window.IsCurrent():
            return
    raise machine.no_drawing()


def _loads(library: str) -> bool:
    """Whether a shared library is there."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
