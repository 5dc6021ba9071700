"""Frictional contact, three ways to enforce it, and their derivatives.

    import stickslip
    result = stickslip.run("studies/scenes/slider.json", method="penalty", set={"/contacts/sole/friction": 0.4})
    result.responses["u"], result.sensitivities["u"]["mu"]

`run` simulates a scene, `explain` says what it holds, `gradcheck` holds every derivative against differences, `study`
compares methods; `load_run` and `load_study` read what a run or a study left. `stickslip.plots` draws tractions and work-precision
diagrams (matplotlib). Scenes and studies are the files of the command line, described in docs/; units are those of
the scene, which are to be consistent.
"""

from stickslip._scene import Gradcheck, NotConverged, Result, explain, gradcheck, load_run, run
from stickslip._stickslip import InputError, __version__
from stickslip._study import load_study, study

__all__ = ["Gradcheck", "InputError", "NotConverged", "Result", "explain", "gradcheck", "load_run", "load_study", "run",
           "study", "__version__"]
