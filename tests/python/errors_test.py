"""Exceptions derive from the built-in ones of the same meaning, and name the arguments of the call."""
import inspect
import pickle
import unittest

import evod
from evod import errors
from evod.program import failure
from evod.v1 import commands_pb2 as c, world_pb2

KIN = {
    "InvalidArgument": ValueError, "NotFound": KeyError, "AlreadyExists": ValueError,
       "PermissionDenied": PermissionError,
    "ResourceExhausted": RuntimeError, "FailedPrecondition": RuntimeError, "Aborted": RuntimeError,
    "Unimplemented": NotImplementedError, "Unavailable": ConnectionError, "NoConnection": ConnectionError,
    "Unauthenticated": PermissionError, "Timeout": TimeoutError, "DamagedData": ValueError,
       "FileNotFound": FileNotFoundError,
    "MissingPackage": ImportError, "ProgramFailed": RuntimeError, "AnswerExpired": RuntimeError,
}  # fmt: skip


class Errors(unittest.TestCase):
    def test_every_class_has_its_built_in_kin(self):
        classes = {name: kind for name, kind in inspect.getmembers(errors, inspect.isclass)
                   if issubclass(kind, errors.Error) and kind is not errors.Error}
        self.assertEqual(set(classes), set(KIN))
        for name, kind in classes.items():
            self.assertIs(getattr(evod, name), kind)
            self.assertTrue(issubclass(kind, KIN[name]), name)
            self.assertIn(f"── {name} ", errors.__doc__)
            error = kind("what happened", [errors.Violation("seed", "0", "1")])
            self.assertEqual(str(error), "what happened\n  seed: got 1, allowed 0")

    def test_no_message_controls_the_terminal(self):
        for text in "w\x1b[2J", "w\x9b31m", "w\u202e":
            error = errors.NotFound(f"there is no world 'v'; the worlds are: {text}",
                                    [errors.Violation("a", text, text)])
            self.assertNotRegex(str(error) + repr(error.args) + str(errors.copy_of(error)), "[\x1b\x9b\u202e]")
        self.assertEqual(str(errors.ProgramFailed("two\nlines")), "two\nlines")

    def test_every_code_has_a_class(self):
        for code in c.Code.values():
            if code != c.CODE_UNSPECIFIED:
                error = errors.refusal(c.Status(code=code, message="no", reason=c.REASON_RUN_ENDED))
                self.assertIsNot(type(error), errors.Error, c.Code.Name(code))
                self.assertEqual((error.code, error.reason), (code, c.REASON_RUN_ENDED))
        unknown = errors.refusal(c.Status(code=99, message="no"))
        self.assertEqual((type(unknown), unknown.code_name), (errors.Error, "code 99"))

    def test_texts_of_the_server_control_no_terminal(self):
        hostile = "a\x1b[2J\x9b31m\u202e\u2028b\n"
        status = c.Status(code=c.CODE_ABORTED, message=hostile, violations=[
            world_pb2.Violation(field=hostile, allowed=hostile, got=hostile)])
        error = errors.refusal(status)
        for text in (error.message, *error.violations[0]):
            self.assertEqual(text, "a?[2J?31m??b?")

    def test_errors_are_pickled_whole(self):
        status = c.Status(code=c.CODE_ABORTED, message="m", reason=c.REASON_REVISION_CHANGED,
                          violations=[world_pb2.Violation(field="set_parameters.x", allowed="a", got="g")])
        error = errors.refusal(status)
        for copy in (pickle.loads(pickle.dumps(error)), errors.copy_of(error)):
            self.assertIs(type(copy), evod.Aborted)
            self.assertEqual((copy.message, copy.violations, copy.code, copy.reason),
                             (error.message, error.violations, error.code, error.reason))

    def test_messages_contain_no_paths_of_the_protocol(self):
        status = c.Status(code=c.CODE_INVALID_ARGUMENT, message="get_history.last_generation must be at least "
                                                                "first_generation",
                          violations=[world_pb2.Violation(field="set_view.view.region.width_px", allowed="a", got="g")])
        error = errors.refusal(status)
        self.assertEqual(error.message, "last must be at least first")
        self.assertEqual(error.violations[0].field, "region.width_px")
        with evod.local(seed=1) as lab, self.assertRaises(ValueError) as raised:
            lab.world().run(generations=0)
        self.assertEqual(str(raised.exception),
                         "generations: got 0, allowed at least 1")

    def test_errors_of_the_program_name_arguments(self):
        error = failure("evod: --keep-every: got x, allowed a whole number\nSee evod --help\n")
        self.assertEqual(error.violations, (errors.Violation("keep_every", "a whole number", "x"),))
        printed = "evod: /tmp/a.json: invalid sweep\n  grid.size (line 3): got a, b, allowed x, y\n"
        error = failure(printed, "/tmp/a.json: ")
        self.assertEqual(str(error), "invalid sweep\n  grid.size: got a, b, allowed x, y")
        error = failure("evod: warning: seed 9\nevod: use --data or --port\n")
        self.assertEqual((type(error), str(error)), (evod.ProgramFailed, "use data or port"))


class Local(unittest.TestCase):
    def refused(self, *fields, **arguments):
        with self.assertRaises(evod.InvalidArgument) as raised:
            evod.local(**arguments)
        self.assertEqual([violation.field for violation in raised.exception.violations], list(fields))
        self.assertNotIn("--", str(raised.exception))
        self.assertNotIn("/tmp", str(raised.exception))

    def test_wrong_arguments_of_local_are_named(self):
        self.refused("seed", seed=-1)
        self.refused("threads", threads=0)
        self.refused("speed", speed="fast")
        self.refused("selection", "mutation_chance", experiment={"selection": "best", "mutation_chance": 2})
        with self.assertRaisesRegex(FileNotFoundError, "experiment: there is no file nowhere.json"):
            evod.local(experiment="nowhere.json")
        with self.assertRaisesRegex(FileNotFoundError, "the program nowhere was not found"):
            evod.local(program="nowhere")


if __name__ == "__main__":
    unittest.main()
