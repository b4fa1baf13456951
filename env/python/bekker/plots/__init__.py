"""Figures of a diagnosis. Needs matplotlib; use the methods ``plot_*`` of :class:`bekker.Diagnosis`."""

try:
    import matplotlib as _  # noqa: F401
except ImportError as error:  # pragma: no cover
    raise ImportError("plots need matplotlib: pip install 'bekker[plot]'") from error

from .effects import candidates, profiles
from .measured import overlay
from .misfit import heatmap, residuals, steps

__all__ = ["candidates", "heatmap", "overlay", "profiles", "residuals", "steps"]
