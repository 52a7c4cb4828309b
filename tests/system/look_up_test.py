"""An endless host name look-up keeps no program beyond its time limit. EVOCTL names the program,
ENDLESS_LOOK_UP_LIBRARY what makes getaddrinfo() wait for ever.
"""
import os
import unittest

import waiting


class LookUp(unittest.TestCase):
    def test_the_time_limit_holds_while_a_name_is_looked_up(self):
        done = waiting.run([os.environ["EVOCTL"], "--server", "lab.example", "--timeout", "0.2", "worlds"],
                           env={**os.environ, "LD_PRELOAD": os.environ["ENDLESS_LOOK_UP_LIBRARY"]},
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("no connection with lab.example", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
