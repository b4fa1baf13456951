"""The workbench in a notebook or a browser: :func:`studio` and its :class:`Studio`."""

import html
import sys
import webbrowser
from collections.abc import Iterable, Mapping, Sequence
from types import TracebackType

from typing_extensions import Self

from . import _bekker
from .errors import InputError
from .experiment import ExperimentLike, sources, together_of
from .models import ModelLike, given
from .soil import SoilLike, passed

__all__ = ["Studio", "studio"]


class Studio:
    """A workbench that answers on this machine until :meth:`stop`, or the end of Python.

    The last value of a notebook's cell shows it there; :meth:`open` shows it in a tab of the browser. It is a context
    manager, which stops it at the end.
    """

    def __init__(self, native: _bekker.NativeStudio, height: int) -> None:
        self._native = native
        self._height = height

    @property
    def url(self) -> str:
        """The address for a browser on this machine."""
        return self._native.url

    @property
    def running(self) -> bool:
        """Whether it still answers."""
        return self._native.running()

    def open(self) -> bool:
        """Shows it in a tab of the browser; False where there is none to be found."""
        if not self.running:
            raise InputError("this workbench was stopped: bekker.studio(...) starts another one")
        return webbrowser.open(self.url)

    def stop(self) -> None:
        """Ends it. What was accepted on the page is gone unless it was saved there."""
        self._native.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, raised: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"<Studio at {self.url}{'' if self.running else ', stopped'}>"

    def _repr_html_(self) -> str:
        if not self.running:
            return "<p>This workbench was stopped.</p>"
        address = html.escape(self.url, quote=True)
        return (
            f'<iframe src="{address}" title="Bekker workbench" width="100%" height="{self._height}" '
            'style="border:1px solid #8886;border-radius:6px"></iframe>'
            f'<p><a href="{address}" target="_blank" rel="noopener">Open it in a tab</a></p>'
        )


def studio(
    *experiments: ExperimentLike | Sequence[ExperimentLike],
    model: ModelLike | None = None,
    parameters: Mapping[str, float] | None = None,
    soil_from: SoilLike | None = None,
    soil_scatter: float | None = None,
    share: Iterable[str] | None = None,
    port: int = 0,
    height: int = 900,
) -> Studio:
    """Opens the workbench on experiments: the page of ``bekker studio``, in the cell of a notebook or in a browser.

    It listens on this machine's loopback interface only; a kernel on another machine needs a tunnel to its port. Pages of
    notebooks on this machine may show it within theirs, other sites may not. Several experiments are chosen from on the
    page. A list of experiments is a set on one soil, as for :func:`bekker.diagnose`: ``bekker.studio(["plates", "wheel"])``
    fits them together.

    Args:
        experiments: folders, :class:`Experiment` objects, or lists of them, one or more.
        model: the model beside them, as for :func:`compare`.
        parameters: values of parameters by name, SI units.
        soil_from: what another experiment found of the soil, as in :func:`bekker.compare`.
        soil_scatter: for lists, as in :func:`bekker.diagnose`.
        share: for lists, as in :func:`bekker.diagnose`.
        port: the port to listen on; 0 takes a free one.
        height: height of the page in a notebook, pixels.

    Raises:
        InputError: no experiment is given, the port is taken, or a file cannot be read.
        ModelError: an experiment does not fit its model.
    """
    if not experiments:
        raise InputError("no experiment is given: expected a folder or an Experiment, for example bekker.studio('drives')")
    if not 0 <= port <= 65535:
        raise InputError(f"port: {port} is none, expected 0 to 65535")
    if height < 100:
        raise InputError(f"height: {height} pixels show nothing, expected 100 or more")
    asked, values = given(model, parameters)
    in_notebook = "ipykernel" in sys.modules
    opened = [sources(experiment) for experiment in experiments]
    lists = [one for one in experiments if isinstance(one, Sequence) and not isinstance(one, str)]
    together = together_of(lists[0] if lists else experiments[0], soil_scatter, share)
    return Studio(_bekker.open_studio(opened, asked, values, passed(soil_from), together, port, in_notebook), height)
