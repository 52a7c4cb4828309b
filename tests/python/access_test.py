"""Tokens and TLS."""
import os
import pathlib
import subprocess
import tempfile
import unittest
from unittest import mock

import evod
from support import PROGRAM, Server


class Access(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.options = ["--data", str(self.folder)]

    def token(self, name, role):
        command = [PROGRAM, "token", "add", name, "--role", role, *self.options]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()[-1]

    def serve(self, *options):
        server = Server(*self.options, *options)
        self.addCleanup(server.kill)
        return f"localhost:{server.port}"

    def test_tokens_give_their_roles(self):
        viewer = self.token("anna", "viewer")
        address = self.serve("--require-token")
        with evod.connect(address, token=viewer) as lab:
            self.assertEqual((lab.role, lab.welcome.user), ("viewer", "anna"))
            with self.assertRaisesRegex(PermissionError, "needs the role controller"):
                lab.world().run()
        file = self.folder / "token"
        file.write_text(viewer + "\n")
        file.chmod(0o600)
        evod.connect(address, token_file=str(file)).close()
        file.chmod(0o644)
        with self.assertRaisesRegex(evod.Error, "other users can read the file: run chmod 600 on it"):
            evod.connect(address, token_file=str(file))
        pipe = self.folder / "pipe"
        os.mkfifo(pipe, 0o600)
        for path, kind in (str(pipe), "a pipe"), (str(self.folder), "a folder"), ("/dev/zero", "a device"):
            for what in ({"token_file": path}, {"ca": path}, {"tls": True, "cert": path}):
                with self.assertRaisesRegex(evod.Error, f"this is {kind}"):
                    evod.connect(address, **what)
        os.environ["EVOD_TOKEN"] = viewer
        self.addCleanup(os.environ.pop, "EVOD_TOKEN")
        evod.connect(address).close()
        with self.assertRaises(evod.NoConnection) as raised:
            evod.connect(address, token="")
        self.assertEqual(raised.exception.code_name, "UNAUTHENTICATED")

    def test_a_revoked_token_fails_waiting_calls(self):
        token = self.token("otto", "admin")
        lab = evod.connect(self.serve("--require-token"), token=token)
        self.addCleanup(lab.close)
        waiting = lab.world().events()
        subprocess.run([PROGRAM, "token", "revoke", "otto", *self.options], check=True, capture_output=True)
        with self.assertRaises(evod.NoConnection) as raised:
            next(waiting)
        self.assertEqual(raised.exception.code_name, "UNAUTHENTICATED")

    def test_a_local_server_ignores_token_and_ca(self):
        with mock.patch.dict(os.environ, EVOD_TOKEN="wrong", EVOD_CA="/no/such.pem"):
            evod.local().close()

    def test_tls_verifies_the_server_certificate(self):
        subprocess.run([PROGRAM, "certificate", "localhost"], cwd=self.folder, check=True, capture_output=True)
        ca, key = str(self.folder / "evod.crt"), str(self.folder / "evod.key")
        secured = ["--tls-cert", ca, "--tls-key", key]
        address = self.serve(*secured, "--seed", "1")
        with evod.connect(address, ca=ca) as lab, lab.world().snapshots() as snapshots:
            self.assertEqual(len(next(snapshots).organisms), 50)
        with mock.patch.dict(os.environ, EVOD_CA=ca):
            evod.connect(address).close()
        with self.assertRaisesRegex(evod.NoConnection, "its certificate is not trusted"):
            evod.connect(address, tls=True)
        with self.assertRaisesRegex(evod.Error, "no-such.pem cannot be used for TLS: No such file"):
            evod.connect(address, ca="no-such.pem")
        with self.assertRaisesRegex(evod.Error, "key requires cert"):
            evod.connect(address, key=key)
        with self.assertRaises(evod.NoConnection):
            evod.connect(address)
        with evod.local() as clear, self.assertRaisesRegex(evod.NoConnection, "no TLS with .*: wrong version number"):
            evod.connect(clear.address, tls=True)

    def test_a_server_can_require_a_client_certificate(self):
        subprocess.run([PROGRAM, "certificate", "localhost"], cwd=self.folder, check=True, capture_output=True)
        ca, key = str(self.folder / "evod.crt"), str(self.folder / "evod.key")
        address = self.serve("--tls-cert", ca, "--tls-key", key, "--tls-client-ca", ca)
        evod.connect(address, ca=ca, cert=ca, key=key).close()
        with self.assertRaises(evod.NoConnection):
            evod.connect(address, ca=ca)


if __name__ == "__main__":
    unittest.main()
