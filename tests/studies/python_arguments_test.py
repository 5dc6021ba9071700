"""The Python module, arguments of other kinds: what was given and what is allowed is said, whatever it is.

PYTHONPATH=build/python/python STICKSLIP_SCENES=studies/scenes python3 tests/studies/python_arguments_test.py
"""

import os
import pathlib
import tempfile
import types
import unittest

import numpy as np

import stickslip

SCENES = pathlib.Path(os.environ["STICKSLIP_SCENES"])
STOP, STUDY = SCENES / "stop.json", SCENES / "stop.study.json"
NO_PATHS = [3, 1.5, [1], object(), 1j, range(2)]
NO_NAMES = ["a\ud800b", pathlib.Path("a\ud800"), "a\0b", ""]
NO_JSON = [1j, b"x", range(3), object(), {1, 2}, {3: 1}, np.array(1j), np.datetime64("2020"), [[b"x"]],
           {"a": object()}, np.array([object()]), Ellipsis]
SCENE_FUNCTIONS = [stickslip.run, stickslip.explain, stickslip.gradcheck]


class Arguments(unittest.TestCase):
    def refused(self, kind, call, *words):
        """Exactly this exception, not one of its children, whose text has the words."""
        with self.assertRaises(kind) as caught:
            call()
        self.assertIs(type(caught.exception), kind, caught.exception)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_a_scene_is_a_path_or_a_dict(self):
        for function in SCENE_FUNCTIONS:
            for value in [None, *NO_PATHS]:
                with self.subTest(function=function.__name__, value=value):
                    self.refused(TypeError, lambda: function(value), f"({type(value).__name__})",
                                 "allowed: the path of a scene file, or a dict of the same content")
            for value in NO_NAMES:
                with self.subTest(function=function.__name__, value=value):
                    self.refused(stickslip.InputError, lambda: function(value), "scene is ")

    def test_a_value_that_json_has_not_is_named_with_its_place(self):
        for function in SCENE_FUNCTIONS:
            for value in NO_JSON:
                with self.subTest(function=function.__name__, value=value):
                    self.refused(TypeError, lambda: function({"bodies": {"a": [value]}}), "scene/bodies/a/0", "allowed")
                    self.refused(TypeError, lambda: function(STOP, set={"/title": value}), "set['/title']", "allowed: ")
        scene = types.MappingProxyType({"bodies": 1j})
        self.refused(TypeError, lambda: stickslip.run(scene), "scene/bodies is 1j (complex)")

    def test_what_is_no_finite_number_is_named(self):
        for value in (float("nan"), np.inf, np.array([1.0, -np.inf])):
            self.refused(stickslip.InputError, lambda: stickslip.run(STOP, set={"/time/end": value}), "set['/time/end']",
                         "must be a finite number")
        self.refused(stickslip.InputError, lambda: stickslip.run({"time": {"end": np.nan}}), "scene/time/end is nan")

    def test_a_text_of_json_is_no_path(self):
        self.refused(stickslip.InputError, lambda: stickslip.run('{"title": "a"}'), "json.loads(text)")

    def test_faults_speak_of_arguments(self):
        for call, words in (
                (lambda: stickslip.run(STOP, set={"/time/end": -1}), "set /time/end=-1: "),
                (lambda: stickslip.run(STOP, method="magic"), "method magic: "),
                (lambda: stickslip.run(STOP, method="penalty", set={"/method/uzawa_al/scale": 2}), "add method uzawa_al"),
                (lambda: stickslip.run(SCENES / "slider.json", set={"mu": 0.1}),
                 "the parameter mu is /contacts/sole/friction")):
            self.refused(stickslip.InputError, call, words)
        with tempfile.TemporaryDirectory() as folder:
            stickslip.run(STOP, folder=folder)
            self.refused(stickslip.InputError, lambda: stickslip.load_study(folder), "holds a run and no study")
            self.refused(stickslip.InputError, lambda: stickslip.study(STUDY, folder), "folder=DIR writes to another")

    def test_a_text_with_a_surrogate_is_named(self):
        self.refused(stickslip.InputError, lambda: stickslip.run({"title": "\ud800"}), "scene/title", "surrogate")
        self.refused(stickslip.InputError, lambda: stickslip.run({"\ud800": 1}), "a key of scene", "surrogate")
        self.refused(stickslip.InputError, lambda: stickslip.run(STOP, set={"/\ud800": 1}), "a key of set", "surrogate")
        self.refused(stickslip.InputError, lambda: stickslip.run(STOP, method="\ud800"), "method", "surrogate")

    def test_what_holds_itself_is_refused(self):
        scene = {}
        scene["bodies"] = scene
        self.refused(stickslip.InputError, lambda: stickslip.run(scene), "holds itself")

    def test_set_is_a_dict_of_pointers(self):
        for function in SCENE_FUNCTIONS:
            for value in [None, 3, "x", [("/title", "a")], {"/title"}]:
                with self.subTest(value=value):
                    self.refused(TypeError, lambda: function(STOP, set=value), "set is ", "a dict of JSON pointers")
            for key in [3, None, b"/title", ("/title",)]:
                with self.subTest(key=key):
                    self.refused(TypeError, lambda: function(STOP, set={key: 1}), "a key of set is ", "JSON pointer")

    def test_method_check_and_folder(self):
        for function in SCENE_FUNCTIONS:
            for value in [3, b"penalty", ["penalty"]]:
                self.refused(TypeError, lambda: function(STOP, method=value), "method is ", "allowed: penalty")
        self.refused(TypeError, lambda: stickslip.run(STOP, check="no"), "check is 'no' (str); allowed: True or False")
        for value in NO_PATHS:
            self.refused(TypeError, lambda: stickslip.run(STOP, folder=value), "folder is ", "allowed: a path")
        for value in NO_NAMES:
            self.refused(stickslip.InputError, lambda: stickslip.run(STOP, folder=value), "folder is ")

    def test_a_path_of_bytes_is_a_path(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.fsencode(folder) + b"/out\xff"  # no UTF-8
            result = stickslip.run(os.fsencode(STOP), folder=out)
            self.assertTrue(result.converged)
            self.assertTrue(os.path.exists(out + b"/result.json"))
            self.assertTrue(stickslip.run(STOP, folder=os.fsdecode(out)).converged)

    def test_arguments_of_a_study(self):
        for value in [None, *NO_PATHS]:
            self.refused(TypeError, lambda: stickslip.study(value), "study is ", "allowed: a path")
            self.refused(TypeError, lambda: stickslip.load_study(value), "folder is ", "allowed: a path")
        for value in NO_NAMES:
            self.refused(stickslip.InputError, lambda: stickslip.study(value), "study is ")
            self.refused(stickslip.InputError, lambda: stickslip.study(STUDY, value), "folder is ")
            self.refused(stickslip.InputError, lambda: stickslip.load_study(value), "folder is ")
        for name in ("resume", "restart"):
            for value in ["no", None, 2]:
                self.refused(TypeError, lambda: stickslip.study(STUDY, "out", **{name: value}), name, "True or False")
        for value in ["2", 1.5, None]:
            self.refused(TypeError, lambda: stickslip.study(STUDY, "out", jobs=value), "jobs is ", "a whole number")
        for value in [0, -1, 1025, 10**30]:
            self.refused(stickslip.InputError, lambda: stickslip.study(STUDY, "out", jobs=value), "must be 1 to 1024")
        for value in [1, None, b"1/1"]:
            self.refused(TypeError, lambda: stickslip.study(STUDY, "out", shard=value), "shard is ", '"1/4"')
        self.assertFalse(os.path.exists("out"))

    def test_steps_and_names_of_a_result(self):
        result = stickslip.run(STOP)
        for call in (result.displacement, lambda step: result.contact("stop", step)):
            for step in ["x", 1.5, None]:
                self.refused(TypeError, lambda: call(step), "step is ", "a whole number")
            for step in [1, -2, 10**30]:
                self.refused(IndexError, lambda: call(step), f"there is no step {step}: the result has 1")
        self.refused(KeyError, lambda: result.contact("stpo"),
                     "there is no contact 'stpo'; did you mean 'stop'? there are: stop")
        response, *_ = result.responses
        for known in (result.responses, result.sensitivities):
            self.refused(KeyError, lambda: known[response + "s"],
                         f"there is no response '{response}s'; did you mean '{response}'? there are: ")
        parameter, *_ = result.sensitivities[response]
        self.refused(KeyError, lambda: result.sensitivities[response][parameter + "u"],
                     f"there is no parameter '{parameter}u'; did you mean '{parameter}'? there are: ")
        self.refused(KeyError, lambda: result.contact("soul"), "there is no contact 'soul'; there are: stop")
        self.refused(KeyError, lambda: result.displacement_derivative("nu"), "there is no parameter 'nu'; there are: ")
        for name in [3, None, ["stop"]]:
            self.refused(TypeError, lambda: result.contact(name), "the name of a contact")
            self.refused(TypeError, lambda: result.displacement_derivative(name), "the name of a parameter")
        np.testing.assert_array_equal(result.displacement(np.int64(0)), result.displacement(-1))

    def test_arguments_of_plots(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("matplotlib is not here")
        matplotlib.use("agg")
        from stickslip import plots

        result = stickslip.run(STOP)
        for value in [3, None, "x", {}]:
            self.refused(TypeError, lambda: plots.tractions(value), "result is ", "stickslip.Result")
        for value in [3, None, {}]:
            self.refused(TypeError, lambda: plots.work_precision(value), "study is ", "load_study()")
        self.refused(stickslip.InputError, lambda: plots.work_precision("x"), "x/results.jsonl: there is no such file")
        for name in ("of", "against", "work"):
            self.refused(TypeError, lambda: plots.work_precision([{}], **{name: b"x"}), f"{name} is b'x' (bytes)")
        self.refused(TypeError, lambda: plots.tractions(result, ax="x"), "axes of matplotlib")


if __name__ == "__main__":
    unittest.main()
