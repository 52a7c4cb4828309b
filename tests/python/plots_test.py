"""Plots of islands and runs: the drawn data are those of the snapshot or the statistics."""
import dataclasses
import pathlib
import tempfile
import unittest

import numpy

import evod


class Plots(unittest.TestCase):
    def test_an_island_is_plotted_true_to_scale(self):
        with evod.local(seed=3, experiment={"crate_count": 3, "obstacle_count": 2}) as lab:
            snapshot = lab.world().snapshot()
        axes = snapshot.plot()
        obstacles, crates, food, poison, organisms = axes.collections
        numpy.testing.assert_array_equal(organisms.get_offsets()[:, 0], snapshot.organisms.x_px)
        numpy.testing.assert_array_equal(organisms.get_array(), snapshot.organisms.health)
        self.assertEqual([len(x.get_offsets()) for x in (food, poison)], [len(snapshot.food), len(snapshot.poison)])
        self.assertEqual([len(x.get_paths()) for x in (obstacles, crates)], [2, 3])
        left = crates.get_paths()[0].vertices[:, 0].min()
        self.assertEqual(left, snapshot.crates.x_px[0] - snapshot.crates.half_width_px[0])
        self.assertEqual((axes.get_xlim(), axes.get_ylim()), ((0, snapshot.width_px), (snapshot.height_px, 0)))

    def test_curves_show_the_statistics_of_all_islands(self):
        experiment = {"island_count": 2, "population_size": 10, "generation_s": 2}
        with evod.local(seed=3, experiment=experiment) as lab:
            world = lab.world()
            with self.assertRaisesRegex(evod.Error, "no generation has ended yet"):
                world.plot_fitness()
            generations = list(world.run(3))
            mean, best = world.plot_fitness().lines
            numpy.testing.assert_allclose(mean.get_ydata(), [g.mean for g in generations])
            numpy.testing.assert_allclose(best.get_ydata(), [g.best for g in generations])
            genes = world.plot_genes().lines
            numpy.testing.assert_allclose([line.get_ydata() for line in genes],
                                          numpy.array([g.genes for g in generations]).T)

    def test_a_sweep_of_one_parameter_is_curves(self):
        sweep = evod.sweep({"island_count": 2, "population_size": 10, "generation_s": 2}, generations=4, replicates=3,
                           seed=1, grid={"selection": ["random", "tournament"]})
        axes = sweep.plot()
        self.assertEqual([line.get_label() for line in axes.lines], ["random", "tournament"])
        last = axes.lines[1].get_ydata()[-1]
        totals = sweep.totals
        expected = totals[(totals.selection == "tournament") & (totals.generation == 4)].fitness_mean.mean()
        self.assertAlmostEqual(last, expected)
        self.assertEqual(len(axes.collections), 2)
        self.assertIn("diversity", sweep.plot("diversity").get_ylabel())
        self.assertIn("data:image/png", sweep._repr_html_())
        with self.assertRaisesRegex(evod.InvalidArgument, "measure"):
            sweep.plot("size")

    def test_a_sweep_of_two_parameters_is_a_heat_map(self):
        world = {"population_size": 10, "generation_s": 1}
        grid = {"mutation_chance": [0.1, 0.2, 0.3], "selection": ["random", "tournament"]}
        sweep = evod.sweep(world, generations=2, replicates=2, seed=1, grid=grid)
        axes = sweep.plot()
        cells = sweep.last.groupby(["mutation_chance", "selection"], sort=False).fitness_mean.mean()
        numpy.testing.assert_allclose(axes.images[0].get_array(), cells.unstack())
        self.assertEqual([label.get_text() for label in axes.get_yticklabels()], ["0.1", "0.2", "0.3"])
        self.assertEqual([label.get_text() for label in axes.get_xticklabels()], ["random", "tournament"])
        points = {"samples": 5, "parameters": {name: {"from": 0.1, "to": 0.4}
                                               for name in ("mutation_chance", "crossover_chance")}}
        scattered = evod.sweep(world, generations=2, seed=1, latin_hypercube=points).plot()
        self.assertEqual(len(scattered.collections[0].get_offsets()), 5)

    def test_a_stored_sweep_is_the_sweep(self):
        world = {"population_size": 10, "generation_s": 1}
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(evod.FileNotFound, "runs.csv"):
                evod.open_sweep(folder)
            made = evod.sweep(world, generations=2, seeds=[5, 2**64 - 1], out=folder,
                              grid={"mutation_chance": [0.1, 0.2], "selection": ["random", "tournament"]})
            for path in folder, folder + "/runs.csv":
                stored = evod.open_sweep(path)
                self.assertEqual(dataclasses.astuple(stored), dataclasses.astuple(made))
            numpy.testing.assert_array_equal(stored.plot().images[0].get_array(), made.plot().images[0].get_array())
            (pathlib.Path(folder) / "other.csv").write_text("a,b\n1,2\n")
            with self.assertRaisesRegex(evod.DamagedData, "not the table of a sweep"):
                evod.open_sweep(folder + "/other.csv")

    def test_a_sweep_of_three_parameters_has_no_plot(self):
        grid = {"mutation_chance": [0.1], "selection": ["random"], "crossover_chance": [0.5]}
        sweep = evod.sweep({"population_size": 10, "generation_s": 1}, generations=2, seed=1, grid=grid)
        with self.assertRaisesRegex(evod.FailedPrecondition, "3 swept parameters"):
            sweep.plot()
        self.assertNotIn("<img", sweep._repr_html_())

    def test_selection_plots_show_all_islands(self):
        experiment = {"island_count": 2, "population_size": 10, "generation_s": 2, "migration": "ring",
                      "migration_epoch": 1}
        with tempfile.TemporaryDirectory() as folder:
            with evod.local(seed=3, experiment=experiment, data=folder) as lab:
                world = lab.world()
                generations = list(world.run(4))
                axes = world.plot_selection("body_size")
                with self.assertRaisesRegex(evod.Error, "gene: got 'size', allowed normal_speed, impulse, body_size"):
                    world.plot_selection("size")
            with evod.open_run(folder + "/default.evod") as run:
                from_file = run.plot_selection("body_size")
                table = run.generations()
        lines = {line.get_label(): line.get_ydata() for line in axes.lines}
        for part in ("selection", "transmission", "migration", "change"):
            numpy.testing.assert_allclose(lines[part], [getattr(g, part)[2] for g in generations])
            (again,) = (line.get_ydata() for line in from_file.lines if line.get_label() == part)
            numpy.testing.assert_array_equal(again, lines[part])
            self.assertTrue(numpy.isnan(lines[part][0]))
            self.assertFalse(numpy.isnan(lines[part][1:]).any())
            self.assertTrue((lines[part][1:] != 0).all(), part)
        sums = lines["selection"] + lines["transmission"] + lines["migration"]
        numpy.testing.assert_allclose(sums[1:], lines["change"][1:], rtol=1e-9)
        numpy.testing.assert_allclose(lines["change"][1:], numpy.diff([g.genes[2] for g in generations]), atol=1e-10)
        self.assertEqual(list(table["body_size_change"].isna()), [True, True] + [False] * 6)

    def test_a_lineage_is_a_tree_of_those_with_descendants(self):
        experiment = {"island_count": 2, "population_size": 10, "generation_s": 2, "migration": "ring",
                      "migration_epoch": 1}
        with tempfile.TemporaryDirectory() as folder:
            with evod.local(seed=3, experiment=experiment, data=folder) as lab:
                lab.world().run(8).wait()
            with evod.open_run(folder + "/default.evod") as run:
                table = run.lineage()
                last = int(table["generation"].max())
                axes, of_one = run.plot_lineage(), run.plot_lineage((last, 1, 4))
                ancestors = run.lineage((last, 1, 4))
        second, first, points, *_ = axes.collections
        self.assertEqual(len(second.get_segments()), 0)
        places = points.get_offsets()
        self.assertEqual(sum(y == last for _, y in places), 20, "the organisms of the last generation")
        parents = {(row.generation, row.island, row.organism): (row.parent_first_generation, row.parent_first_island,
                   row.parent_first) for row in table.itertuples()}  # fmt: skip
        living, line_count = {name for name in parents if name[0] == last}, 0
        while next(iter(living))[0] > 1:
            line_count += len(living)
            living = {parents[name] for name in living}
        self.assertEqual(len(first.get_segments()), line_count)
        for generation in range(2, last + 1):  # no line crosses another
            lines = sorted((s[-1][0], s[0][0]) for s in first.get_segments() if s[-1][1] == generation)
            self.assertEqual([begin for _, begin in lines], sorted(begin for _, begin in lines))
        second, first, points, *_ = of_one.collections
        self.assertEqual(len(points.get_offsets()), len(ancestors))
        both = ancestors[ancestors["generation"] > 1]
        crossed = both[(both["parent_first"] != both["parent_second"]) |
                       (both["parent_first_island"] != both["parent_second_island"])]
        self.assertEqual(len(first.get_segments()), len(both))
        self.assertEqual(len(second.get_segments()), len(crossed))

    def test_a_notebook_plays_the_animation(self):
        with evod.local(seed=3, speed=10) as lab:
            world = lab.world()
            self.assertIn("</script>", world.animate(3)._repr_html_())  # paused: one snapshot
            world.run()
            self.assertIn("frames[2]", world.animate(3)._repr_html_())


if __name__ == "__main__":
    unittest.main()
