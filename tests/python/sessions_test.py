"""The scenarios of proto/vectors/sessions.json, performed with a Core. The file explains its steps. And other objects
that a forked process has inherited."""
import json
import os
import pathlib
import tempfile
import unittest

from google.protobuf import json_format

import evod
from evod import framing, link, local_server, plans, run_file, transport
from evod.core import Core, Pending
from evod.endpoint import Endpoint
from evod.v1 import commands_pb2 as c, session_pb2

FILE = pathlib.Path(__file__).parents[2] / "proto/vectors/sessions.json"


def text_of(error):
    code = c.Code.Name(error.code or 0)
    return f"refused {code} {c.Reason.Name(error.reason)}" if error.reason else f"refused {code}"


def result_of(pending):
    """The result of a Pending, or of an Error that the call raised."""
    error = pending if isinstance(pending, evod.Error) else pending.error
    if error is not None:
        return "lost" if isinstance(error, evod.NoConnection) else text_of(error)
    if pending.response is None:
        return "waiting"
    status = pending.response.status
    return text_of(evod.errors.refusal(status)) if status.code else "answered"


def in_forked_process(function):
    """Calls a function in a forked process and returns its text. Fails if the process does not end."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writing, function().encode())
        finally:
            os._exit(0)
    os.close(writing)
    os.waitpid(child, 0)
    with os.fdopen(reading) as output:
        return output.read()


def call(perform):
    try:
        perform()
    except evod.NoConnection as error:
        return "lost" if "call connect() in each process" in str(error) else str(error)
    return "answered"


class Player:
    """A client and the server's end of its session."""

    def __init__(self, test):
        self.test = test
        self.core = Core(token="", client_name="test", server="lab:1")
        self.backoff = transport.Backoff()
        self.reader = framing.FrameReader()
        self.ids, self.requests, self.subscriptions = {}, {}, {}
        self.plans = []  # [plan, the Pending or Until that it waits for]

    def play(self, step):
        ((kind, value),) = step.items()
        getattr(self, kind)(value)
        self.continue_plans()

    # ---- the server

    def receive(self, message):
        try:
            self.core.received(framing.encode(message.SerializeToString()))
        except evod.NoConnection as error:
            self.end(error)

    def end(self, error):
        self.backoff.failed(self.core.retry_late)
        self.core.lost(error)

    def connect(self):
        self.core.opened()
        self.reader = framing.FrameReader()
        (hello,) = self.messages()
        self.test.assertEqual(hello.hello.protocol_version, 1)

    def open(self, fields):
        self.connect()
        welcome = json_format.ParseDict({"protocol_version": 1, **fields}, session_pb2.Welcome())
        self.receive(session_pb2.ServerMessage(welcome=welcome))
        self.test.assertTrue(self.core.connected)
        self.backoff.reset()

    def refuse(self, status):
        self.connect()
        self.goodbye(status)

    def goodbye(self, status):
        goodbye = session_pb2.Goodbye(status=json_format.ParseDict(status, c.Status()))
        self.receive(session_pb2.ServerMessage(goodbye=goodbye))

    def lose(self, _):
        self.end(evod.NoConnection("the connection was lost"))

    def answer(self, value):
        response = json_format.ParseDict(value["fields"], c.Response(request_id=self.ids[value["name"]]))
        self.receive(session_pb2.ServerMessage(response=response))

    # ---- the program

    def request(self, value):
        try:
            self.requests[value["name"]] = self.core.request(json_format.ParseDict(value["fields"], c.Request()))
        except evod.Error as error:
            self.requests[value["name"]] = error

    def forget(self, name):
        self.core.forget(self.requests[name])

    def subscribe(self, value):
        self.subscriptions[value["name"]] = self.core.subscribe(json_format.ParseDict(value["fields"], c.Request()))

    def unsubscribe(self, name):
        self.core.unsubscribe(self.subscriptions[name])

    def set_view(self, value):
        stream = plans.SnapshotStream(self.core, self.subscriptions[value["name"]])
        plan = stream.set_view(json_format.ParseDict(value["view"], c.View()))
        self.plans.append([plan, next(plan)])

    def continue_plans(self):
        """Performs the plans as a Link does."""
        for entry in list(self.plans):
            plan, step = entry
            try:
                while True:
                    if isinstance(step, c.Request):
                        step = self.core.request(step)
                    if isinstance(step, Pending) and step.done:
                        refused = step.error is None and step.response.status.code
                        error = evod.errors.refusal(step.response.status) if refused else step.error
                        step = plan.throw(error) if error else plan.send(step.response)
                    elif not isinstance(step, Pending) and step.condition():
                        step = plan.send(None)
                    else:
                        break
                entry[1] = step
            except (StopIteration, evod.Error):
                self.plans.remove(entry)

    def fork(self, value):
        client = link.Link(Endpoint("127.0.0.1", 1), self.core, None, timeout_s=30, reconnect=True)
        self.test.addCleanup(client.close)
        (kind,) = value["fields"]
        result = in_forked_process(lambda: call(lambda: client.perform(plans.request(kind, **value["fields"][kind]))))
        self.test.assertEqual(result, value["result"])
        self.test.assertEqual(in_forked_process(lambda: str(client.apply(lambda: None)) + str(client.close())),
                              "NoneNone")

    # ---- expectations

    def messages(self):
        self.reader.feed(self.core.outgoing())
        return [session_pb2.ClientMessage.FromString(body) for _, body in self.reader.frames()]

    def sent(self, expected):
        requests = [message.request for message in self.messages() if message.HasField("request")]
        for request, wanted in zip(requests, expected):
            self.test.assertEqual(request.client_key, self.core.client_key)
            name = wanted["name"]
            if name not in self.ids:
                self.test.assertNotIn(request.request_id, self.ids.values())
            self.test.assertEqual(request.request_id, self.ids.setdefault(name, request.request_id), name)
            request.ClearField("request_id")
            request.ClearField("client_key")
            self.test.assertEqual(request, json_format.ParseDict(wanted["fields"], c.Request()))
        self.test.assertEqual(len(requests), len(expected), requests)

    def results(self, expected):
        for name, result in expected.items():
            if name not in self.subscriptions:
                self.test.assertEqual(result_of(self.requests[name]), result, name)
                continue
            subscription = self.subscriptions[name]
            found = (text_of(subscription.refused) if subscription.refused
                     else "accepted" if subscription.server_id is not None else "waiting")
            self.test.assertEqual(found, result, name)

    def session(self, expected):
        if self.core.failed is not None:
            found = "gives up"
        elif self.core.connected:
            found = "open"
        else:
            wait_s = self.backoff.retry_at - self.backoff.failed_at
            found = "retries late" if wait_s >= transport.BACKOFF_MAX_S / 2 else "retries soon"
        self.test.assertEqual(found, expected)


class Sessions(unittest.TestCase):
    def test_sessions_end_as_in_the_other_clients(self):
        scenarios = json.loads(FILE.read_text())["scenarios"]
        self.assertTrue(scenarios)
        self.assertEqual(len({scenario["name"] for scenario in scenarios}), len(scenarios))
        for scenario in scenarios:
            if "python" in scenario.get("only", {"clients": ["python"]})["clients"]:
                player = Player(self)
                with self.subTest(scenario["name"]):
                    for step in scenario["steps"]:
                        player.play(step)

    def test_an_expired_answer_has_its_own_error(self):
        error = evod.errors.refusal(c.Status(code=c.CODE_FAILED_PRECONDITION, reason=c.REASON_REQUEST_TOO_OLD))
        self.assertIs(type(error), evod.AnswerExpired)

    def test_closing_a_replay_needs_no_connection(self):
        plan = plans.close_replay("w@1")
        next(plan)
        with self.assertRaises(StopIteration):
            plan.throw(evod.NoConnection("lost"))


class ForkedProcesses(unittest.TestCase):
    def test_a_forked_process_does_not_stop_the_server(self):
        with evod.local() as lab:
            self.assertIn("call connect() in each process", in_forked_process(lambda: str(self.error_of(lab.worlds))))
            self.assertEqual(in_forked_process(lambda: str(lab.close())), "None")
            self.assertEqual([world.name for world in lab.worlds()], ["default"])

    @staticmethod
    def error_of(function):
        try:
            return function()
        except evod.NoConnection as error:
            return error

    def test_a_server_stops_while_a_forked_process_lives(self):
        lab = evod.local()
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(writing)
            os.read(reading, 1)  # until the parent has closed its end
            os._exit(0)
        os.close(reading)
        before, local_server._STOP_TIMEOUT_S = local_server._STOP_TIMEOUT_S, 600
        try:
            lab.close()
        finally:
            local_server._STOP_TIMEOUT_S = before
            os.close(writing)
            os.waitpid(child, 0)

    def test_a_forked_process_deletes_no_folder(self):
        folder = tempfile.mkdtemp()
        self.assertEqual(in_forked_process(lambda: str(run_file._remove(folder, os.getppid()))), "None")
        self.assertTrue(os.path.isdir(folder))
        run_file._remove(folder, os.getpid())
        self.assertFalse(os.path.exists(folder))


if __name__ == "__main__":
    unittest.main()
