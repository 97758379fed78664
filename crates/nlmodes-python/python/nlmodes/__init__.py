"""Nonlinear modes of structures that meet stops.

>>> import nlmodes
>>> result = nlmodes.run("configs/rod.toml", out=False)  # doctest: +SKIP
>>> result.plot()  # doctest: +SKIP

================================  ==========================================================
:func:`run`                       a scene: structure, records of a test, virtual test
:func:`read`                      what a run has left in a directory
:func:`check`, :func:`schema`     what is known before anything is computed
:func:`columns`                   what the columns of results mean
:func:`linear_frequencies`        the linear modes of a scene
:class:`Law`                      a spring or damper whose force is a function
:class:`Structure`                stiffness and mass matrices with contacts
:class:`ReducedStructure`         frequencies, rows and flexibility from elsewhere, with contacts
:class:`Study`                    a quantity over parameters, from many branches; fits to measured points
:func:`follow`                    a fold, a first touch or a mode over a parameter
:func:`verify`                    one period of the full structure from a computed point
:mod:`nlmodes.contact`            complementarity problems of contact
:mod:`nlmodes.continuation`       branches of ``R(x, p) = 0`` with functions of your own
:mod:`nlmodes.experiment`         modal points of records that are in memory
================================  ==========================================================

All quantities are in SI units; the unit is part of the name of a key or column.
"""

from . import contact, continuation, experiment
from ._branch import Branch, History, Motion, Verification
from ._errors import Mistake, RunError, SceneError, SceneWarning
from ._native import __version__
from ._result import Result, read, verify
from ._run import check, columns, linear_frequencies, run, schema
from ._table import Table
from .follow import FollowedCurve, follow
from .law import Law
from .reduced import ReducedStructure
from .structure import Structure
from .study import Fit, Study, StudyTable

__all__ = [
    "Branch",
    "Fit",
    "FollowedCurve",
    "History",
    "Law",
    "Mistake",
    "Motion",
    "ReducedStructure",
    "Result",
    "RunError",
    "SceneError",
    "SceneWarning",
    "Structure",
    "Study",
    "StudyTable",
    "Table",
    "Verification",
    "__version__",
    "check",
    "columns",
    "contact",
    "continuation",
    "experiment",
    "follow",
    "linear_frequencies",
    "read",
    "run",
    "schema",
    "verify",
]
