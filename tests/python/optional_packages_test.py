"""The package works without its optional packages, and names the one that a function needs."""
import subprocess
import sys
import unittest


class OptionalPackages(unittest.TestCase):
    def run_without(self, package, program):
        """Runs a program in which the package cannot be imported; it has a `world`."""
        whole = f"import sys; sys.modules[{package!r}] = None; import evod\nwith evod.local(seed=1) as lab:\n" \
                f"    world = lab.world()\n    {program}"
        return subprocess.run([sys.executable, "-c", whole], capture_output=True, text=True)

    def test_snapshots_arrive_without_zstandard(self):
        done = self.run_without("zstandard", "print(len(next(world.snapshots()).organisms))")
        self.assertEqual(done.stdout, "50\n", done.stderr)

    def test_missing_packages_are_named(self):
        for package, program in (("pandas", "world.history().to_pandas()"), ("pandas", "world.snapshot().to_pandas()"),
                                 ("pandas", "evod.run(seed=1, generations=1).generations()"),
                                 ("matplotlib", "world.plot()")):
            done = self.run_without(package, program)
            self.assertIn(f"need the package {package}: install it, python3-{package} on Debian", done.stderr)

    def test_experiments_run_without_pandas(self):
        done = self.run_without("pandas", "print(evod.sweep(grid={'mutation_chance': [0.1]}, generations=1, seed=1), "
                                          "len(evod.compare(replicates=2, generations=2, seed=1).differences))")
        self.assertEqual(done.stdout, "<sweep of mutation_chance: 1 cells of 1 replicates, seed 1> 4\n", done.stderr)


if __name__ == "__main__":
    unittest.main()
