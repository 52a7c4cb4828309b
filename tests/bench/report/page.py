"""Writes docs/PERFORMANCE.md from the results: every {{name}} of the template is a method here.

Every number of the page comes from the results.
"""
import pathlib
import re

from .figures import count, digits, megabytes, minus, table, with_spread
from .sections import columns, measured_ticks, warm_up_ticks

folder = pathlib.Path(__file__).resolve().parent
program_names = {"evod": "evod", "box2d": "Box2D", "chipmunk_hash": "Chipmunk, hash", "chipmunk_tree": "Chipmunk, tree",
                 "all_pairs": "all pairs", "galib": "GAlib", "deap": "DEAP"}


def percent(spread):
    return minus(f"{spread['median']:+.2f} % ({spread['min']:+.2f} – {spread['max']:+.2f} %)")


class Page:
    def __init__(self, results):
        self.results = results

    def text(self):
        def value(match):
            method = getattr(self, match[1])
            return str(method(*match[2].split()) if match[2] else method())
        text = (folder / "PERFORMANCE.md.in").read_text()
        return re.sub(r"\{\{(\w+)((?: [^{} ]+)*)\}\}", value, text)

    # Where and when

    def machine(self):
        about, load = self.results["about"], self.results["load"]
        model = f"{about['processor']} (family {about['family']}, model {about['model']}" + \
                (", KVM guest or the like)" if about["virtual"] else ")")
        rows = [["machine", f"{about['cores']} cores of {model}, {about['memory_gib']} GiB"],
                ["system", f"{about['system']}, Linux {about['kernel']}"],
                ["compiler", f"{about['compiler']}, preset `release` ({about['flags']})"],
                ["evod", f"version {about['version']}, commit {about['commit']}"],
                ["date", about["date"]],
                ["compared with", ", ".join(f"{name} {version}" for name, version in about["packages"].items())],
                ["load", f"{load['load_before']} before the start; other programs kept {load['others_cores']} cores "
                         "busy "
                         "during the measurements"],
                ["duration", f"{load['minutes']} minutes, {about['repeats']} runs of each program" +
                         (", **with --quick**" if about["quick"] else "") +
                         (", **all other sections are older than " + ", ".join(about["only"]) + "**" if "only" in about
                          else "")]]
        return table(["", ""], rows)

    def repeats(self):
        return self.results["about"]["repeats"]

    def warm_up_ticks(self):
        return warm_up_ticks

    def last_tick(self):
        return warm_up_ticks + measured_ticks

    # The workload

    def _rows(self, **wanted):
        return [row for row in self.results["workload"] if all(row[key] == value for key, value in wanted.items())]

    def _row(self, **wanted):
        rows = self._rows(**wanted)
        return rows[0] if rows else None

    def _populations(self):
        return sorted({row["organisms"] for row in self.results["workload"]})

    def _rate(self, program, organisms, spatial_order=False):
        row = self._row(program=program, organisms=organisms, threads=1, spatial_order=spatial_order)
        return row and row["organism_ticks_per_processor_s"]["median"]

    def _best_engine(self, organisms):
        """The fastest engine other than evod, however its bodies were created: its row, or None."""
        rows = [row for row in self._rows(organisms=organisms, threads=1)
                if row["program"] not in ("evod", "all_pairs")]
        return max(rows, key=lambda row: row["organism_ticks_per_processor_s"]["median"], default=None)

    def engines(self):
        present = {row["program"] for row in self.results["workload"]}
        programs = [name for name in program_names if name in present]
        rows = []
        for organisms in self._populations():
            for spatial_order in (False, True):
                measured = {name: self._row(program=name, organisms=organisms, threads=1, spatial_order=spatial_order)
                            for name in programs}
                if not any(measured.values()):
                    continue
                cells = [with_spread(row["organism_ticks_per_processor_s"], 1e-6) if row else "" for row in
                         measured.values()]
                rows.append([count(organisms) + (", in spatial order" if spatial_order else ""), *cells])
        return table(["organisms", *(program_names[name] for name in programs)], rows)

    def ratios(self):
        rows = []
        for organisms in self._populations():
            best = self._best_engine(organisms)
            if best is None:
                continue
            evod = self._rate("evod", organisms)
            against = [digits(evod / rate) if (rate := self._rate(name, organisms)) else ""
                       for name in ("box2d", "chipmunk_hash", "all_pairs")]
            order = ", in spatial order" if best["spatial_order"] else ""
            rows.append([count(organisms), *against,
                         f"{digits(evod / best['organism_ticks_per_processor_s']['median'])} "
                         f"({program_names[best['program']]}{order})"])
        return table(["organisms", "× Box2D", "× Chipmunk, hash", "× all pairs", "× the fastest other program"], rows)

    def agreement(self):
        rows = self.results["agreement"]
        evod = rows[0]

        def beside(row, key):
            text = digits(row[key])
            if row is evod or not evod[key]:
                return text
            return minus(f"{text} ({100 * (row[key] / evod[key] - 1):+.1f} %)")
        keys = ("food_per_organism_s", "poison_per_organism_s", "speed_mean_px_s", "seeing_food_share", "deaths_share",
                "organism_ticks")
        return table(["", "food eaten per organism and s", "poison eaten", "mean speed, px/s",
                      "share that perceives food",
                      "share that dies", "organism-ticks"],
                     [[program_names[row["program"]], *(beside(row, key) for key in keys)] for row in rows])

    def agreement_scenes(self):
        return self.results["agreement"][0]["scenes"]

    def agreement_worst(self, key):
        """The largest difference of any program from evod, in per cent."""
        rows = self.results["agreement"]
        return f"{max(abs(100 * (row[key] / rows[0][key] - 1)) for row in rows[1:]):.1f}"

    # Threads and populations

    def threads(self):
        rows = []
        for islands, measured in ((1, self.results["workload"]), (64, self.results["islands"])):
            for organisms in sorted({row["organisms"] for row in measured}):
                one, two = ([row["organism_ticks_per_s"] for row in measured if row["program"] == "evod" and
                             row["organisms"] == organisms and row["threads"] == n][0] for n in (1, 2))
                where = f"{islands} islands of {count(organisms)}" if islands > 1 else count(organisms)
                rows.append([where, with_spread(one, 1e-6), with_spread(two, 1e-6),
                             f"{two['median'] / one['median']:.2f}", digits(1e9 / one["median"]),
                             digits(1e9 / two["median"]), digits(two["median"] / (60 * islands * organisms))])
        return table(["organisms", "1 thread, M/s", "2 threads, M/s", "2 threads ÷ 1", "1 thread, ns", "2 threads, ns",
                      "2 threads, × real time"], rows)

    def densities(self):
        names = {"as it is": "the benchmark world of 20,000",
                 "far-sighted": "genes food_radius and poison_radius 1,000 px",
                 "thin": "an island of the same area, a hundred times as long as wide",
                 "default density": "as dense as the default world",
                 "crowded": "all organisms of the maximum size; bodies cover 0.3 of the island",
                 "few organisms": "10 organisms, 1,000,000 food",
                 "many islands": "64 islands of 500"}
        rows = {row["world"]: row for row in self.results.get("densities", [])}
        return table(["world", "ns per organism-tick", "× benchmark world", "µs per tick"],
                     [[names[name], with_spread(row["ns"]),
                       digits(row["ns"]["median"] / rows["as it is"]["ns"]["median"]),
                       digits(row["tick_us"]["median"])] for name in names if (row := rows.get(name))])

    def networks(self):
        names = {"rules": "rules", "newtonian": "networks, newtonian", "kinematic": "networks, kinematic"}
        rows, key = self.results.get("networks", []), "organism_ticks_per_processor_s"
        rules = {row["organisms"]: row[key]["median"] for row in rows if row["steering"] == "rules"}
        return table(["organisms", "steered by", "M organism-ticks/s", "× rules"],
                     [[count(row["organisms"]), names[row["steering"]], with_spread(row[key], 1e-6),
                       digits(row[key]["median"] / rules[row["organisms"]])] for row in rows])

    def instruction_sets(self):
        names = {"baseline": "evod, baseline instructions", "avx2": "evod, AVX2", "avx512": "evod, AVX-512"}
        rows = self.results.get("instruction_sets", [])
        key = "organism_ticks_per_processor_s"
        return table(["20,000 organisms, one thread", "M organism-ticks/s", "× baseline"],
                     [[names[row["instructions"]], with_spread(row[key], 1e-6),
                       digits(row[key]["median"] / rows[0][key]["median"])] for row in rows])

    def _ns(self, organisms):
        return 1e9 / self._row(program="evod", organisms=organisms, threads=1)["organism_ticks_per_s"]["median"]

    def growth(self):
        """The cost of an organism-tick in the largest population, divided by the cost at 2,000."""
        return f"{self._ns(self._populations()[-1]) / self._ns(2_000):.2f}"

    def largest(self):
        return count(self._populations()[-1])

    # Roofs

    def roofs(self):
        rows = []
        for key, name in (("memory_gb_per_s", "triad in memory, 3 × 256 MiB per thread, GB/s"),
                          ("cache_8_mib_gb_per_s", "triad in cache, 8 MiB per thread, GB/s"),
                          ("cache_192_kib_gb_per_s", "triad in cache, 192 KiB per thread, GB/s"),
                          ("instructions_g_per_s", "independent additions, G instructions/s")):
            rows.append([name, *(digits(self.results["machine"][n][key]) for n in ("one_thread", "two_threads"))])
        return table(["", "1 thread", "2 threads"], rows)

    def columns(self):
        rows = [[entry["pass"], entry["columns"], entry["read"], entry["written"]] for entry in columns()]
        rows.append(["**total**", "", *(sum(entry[way] for entry in columns()) for way in ("read", "written"))])
        return table(["pass", "columns", "bytes read", "written"], rows)

    def bytes_per_organism_tick(self):
        return sum(entry["read"] + entry["written"] for entry in columns())

    def _counted(self, work):
        entry = [e for e in self.results["instructions"] if e["work"] == work][-1]
        return entry["instructions"] / entry["units"]

    def instructions_per(self, work):
        return digits(self._counted(work))

    def _largest_rate(self):
        return self._row(program="evod", organisms=self._populations()[-1], threads=1)["organism_ticks_per_s"]["median"]

    def bandwidth_share(self):
        roof = self.results["machine"]["one_thread"]["memory_gb_per_s"]
        return f"{100 * self._largest_rate() * self.bytes_per_organism_tick() / (1e9 * roof):.0f}"

    def instruction_share(self):
        roof = self.results["machine"]["one_thread"]["instructions_g_per_s"]
        rate = self._row(program="evod", organisms=2_000, threads=1)["organism_ticks_per_s"]["median"]
        return f"{100 * rate * self._counted('ticks') / (1e9 * roof):.0f}"

    def counts(self):
        names = {"ticks": "per organism-tick, benchmark world of 2,000",
                 "generation": "per organism-tick, default world, with breeding and placement",
                 "breeding": "per chromosome bred, population of 20,000"}
        return table(["", "instruction set", "instructions"],
                     [[names[e["work"]], e["instruction_set"], digits(e["instructions"] / e["units"])]
                      for e in self.results["instructions"]])

    def phases(self):
        rows = self.results["phases"]
        if not rows:
            return table([], [])
        populations = sorted({row["organisms"] for row in rows})
        ns = {(row["phase"], row["organisms"]): row["ns"]["median"] for row in rows}
        parts = [name for name in dict.fromkeys(row["phase"] for row in rows) if name != "whole tick"]
        whole = {n: ns["whole tick", n] for n in populations}
        body = [[name, *(digits(ns[name, n]) for n in populations)] for name in parts]
        body += [["**total**", *(digits(sum(ns[name, n] for name in parts)) for n in populations)],
                 ["a whole tick of an island, one clock", *(digits(whole[n]) for n in populations)],
                 ["state hash, share of a tick", *(f"{100 * ns['hash', n] / whole[n]:.1f} %" for n in populations)]]
        return table(["ns per organism-tick", *map(count, populations)], body) + \
            "\n\n![phases of a tick](performance/phases.svg)"

    # The genetic algorithm

    def genetic(self):
        rows = self.results["genetic"]
        evod = {row["population"]: row["ms_per_generation"]["median"] for row in rows if row["program"] == "evod"}
        return table(["", "population", "generations", "ms per generation", "× evod", "best fitness at the end"],
                     [[program_names[row["program"]], count(row["population"]), row["generations"],
                       with_spread(row["ms_per_generation"]),
                       digits(row["ms_per_generation"]["median"] / evod[row["population"]]),
                       with_spread(row["fitness_best"])] for row in rows])

    def breeding(self):
        found = self.results["breeding"]
        small = [row for row in found if row["chromosomes"] == 100_000]
        default = [row for row in small if row["choice"] == "population_model=hybrid"][0]
        slowest = [row for row in small if row["choice"] == "slowest choices together"][0]
        single = sorted((row for row in small if row is not slowest), key=lambda row: row["ms"]["median"])
        rows = [["100,000", "the defaults", 1, with_spread(default["ms"])],
                ["100,000", f"the fastest single option, `{single[0]['choice']}`", 1, with_spread(single[0]["ms"])],
                ["100,000", f"the slowest single option, `{single[-1]['choice']}`", 1, with_spread(single[-1]["ms"])],
                ["100,000", "the slowest option of every stage", 1, with_spread(slowest["ms"])]]
        rows += [[count(row["chromosomes"]), "the defaults", row["threads"], with_spread(row["ms"])]
                 for row in found if row["chromosomes"] == 1_000_000]
        return table(["chromosomes", "options", "threads", "ms"], rows)

    # Whole programs

    def runs(self):
        default, large, networks = (self.results["runs"][name] for name in ("default", "large", "networks"))
        return table(["", ""], [
            ["`evod run`, default world, one thread, × real time", with_spread(default["real_time_factor"])],
            ["the same, M organism-ticks/s", with_spread(default["m_organism_ticks_per_s"])],
            [f"`evod run`, benchmark world of {count(large['organisms'])}: start-up, s", digits(large["start_up_s"])],
            ["the same: from one generation to the next, s", digits(large["turnover_s"])],
            ["the same: peak memory (`VmHWM`), MB", megabytes(large["memory_bytes"])],
            ["the same: bytes of memory per organism", digits(large["memory_bytes"] / large["organisms"])],
            [f"the same with networks of 5-8-2, {count(networks['organisms'])} organisms: peak memory (`VmHWM`), MB",
             megabytes(networks["memory_bytes"])]])

    def server(self):
        figures = self.results["server"]
        increase, storage = figures["viewer_rise_percent"], figures["storage"]
        rows = [
            ["from exec to the first client's Welcome, ms", with_spread(figures["start_ms"])],
            [f"one viewer at 30 snapshots/s, {count(figures['organisms'])} organisms and {count(figures['items'])} "
             "items, full "
             "speed: increase of the simulation thread's processor time per tick", percent(increase)],
            [f"recording the run of {count(storage['organisms'])} organisms, full speed: the same increase",
             percent(storage["simulation_rise_percent"])],
            ["processor time of the storage threads, divided by that of the simulation thread",
             percent(storage["storage_share_percent"])],
            ["one of its snapshots, bytes", count(figures["snapshot_bytes"])],
            ["a command to an idle server that records nothing, ms", with_spread(figures["command_at_rest_ms"])],
            ["a command while that world runs at full speed, ms", with_spread(figures["command_beside_ms"])],
            ["a query while it runs, ms", with_spread(figures["query_beside_ms"])],
            ["a command to a server that records its runs: on the disk before the reply, ms",
             with_spread(storage["command_ms"])]]
        if "ready_after_kill_s" in storage:
            rows.append([f"from exec to a client's Welcome, after a kill late in a generation of "
                         f"{count(storage['organisms'])}, s", with_spread(storage["ready_after_kill_s"])])
        return table(["", "median (minimum – maximum)"], rows)

    def run_files(self):
        figures = self.results["run_files"]
        generations = count(figures["generations"])
        rows = [["growth of the default world's file per generation of 50, bytes",
                 count(round(figures["bytes_per_generation"]))],
                [f"seek from any tick of {generations} generations to any other, ms", with_spread(figures["seek_ms"])],
                [f"`evod run`, {generations} generations, all threads, s", with_spread(figures["run_s"])],
                ["`evod verify` of the same run, s", with_spread(figures["verify_s"])],
                ["verify ÷ run", with_spread(figures["verify_over_run"])]]
        for at in figures["checkpoints"]:
            rows += [[f"a tick of {count(at['organisms'])} organisms, recorded, ms", with_spread(at["tick_ms"])],
                     ["the same with a checkpoint", with_spread(at["tick_with_checkpoint_ms"])],
                     ["a checkpoint, bytes", count(at["packed_bytes"])]]
        return table(["", "median (minimum – maximum)"], rows)

    def stream(self):
        def decoding(row):
            return digits(row["decode_ms"]) if "decode_ms" in row else ""
        return table(["organisms", "codec", "bytes per snapshot", "bytes per organism", "bytes per keyframe",
                      "network thread, ms per snapshot", "numpy decodes, ms"],
                     [[count(row["organisms"]), row["codec"], count(round(row["bytes"])),
                       digits(row["bytes_per_organism"]),
                       count(round(row["keyframe_bytes"])) if row.get("keyframes") else "", digits(row["server_ms"]),
                       decoding(row)] for row in self.results["stream"]])

    def package(self):
        generations, snapshots = self.results["package"]["generations"], self.results["package"]["snapshots"]
        organisms = count(snapshots["organisms"])
        return table(["", "median (minimum – maximum)"], [
            ["100 generations with `evod run`, s", with_spread(generations["evod_run_s"])],
            ["the same with `World.run()`, s", with_spread(generations["package_s"])],
            ["ratio of the two", with_spread(generations["ratio"])],
            ["ratio of the simulation's processor time",
             with_spread(generations["ratio_of_processor_s_of_what_simulates"])],
            ["Python's own processor time per generation, ms",
             with_spread(generations["python_processor_ms_a_generation"])],
            [f"snapshots of {organisms} organisms received as arrays, per second", digits(snapshots["come_per_s"])],
            ["the same decoded from memory", digits(snapshots["decoded_alone_per_s"])]] + self.evaluate())

    def evaluate(self):
        figures = self.results["package"].get("evaluate")
        if figures is None:
            return []
        organisms = count(figures["organisms"])
        return [[f"generations of {organisms} organisms with `World.evaluate()` and a NumPy function, per second",
                 with_spread(figures["generations_per_s"])],
                ["the same with a fitness function of evod", with_spread(figures["built_in_generations_per_s"])]]

    def optimisers(self):
        figures = self.results.get("optimisers")
        if figures is None:
            return table([], [])
        numbers = ("evod", "deap", "adjusted_p", "evod_s", "deap_s", "time_ratio")
        rows = [[row["function"], *(digits(row[name]) for name in numbers)] for row in figures["rows"]]
        when = f"Measured on {figures['date']}; the load of the machine was {figures['load']:.1f}.\n\n"
        return when + table(["function", "evod", "DEAP", "p", "evod, s", "DEAP, s", "time, evod to DEAP"], rows)

    def drawing(self):
        def own(row):
            return digits(row["own_ms"]) if "own_ms" in row else ""
        return table(["organisms", "processor time per drawn frame, OpenGL in software included, ms",
                      "a frame with a new snapshot, without the OpenGL calls, ms"],
                     [[count(row["organisms"]), digits(row["ms"]), own(row)] for row in self.results["drawing"]])

    def sizes(self):
        disk = self.results["runs"]["disk_bytes"]
        rows = [["memory of a server with the default world after 5 s at full speed (`VmHWM`), MB",
                 megabytes(self.results["server"]["default_world_memory_bytes"])]]
        rows += [[f"`{name}` on disk, MB", megabytes(size)] for name, size in disk.items()]
        return table(["", ""], rows)

    def clients(self):
        rows = []
        for name, figures in self.results.get("clients", {}).items():
            if "loss_percent" in figures:
                rows.append([name.replace("_", " "), percent(figures["loss_percent"]),
                             percent(figures["others_share_percent"])])
        return table(["clients", "loss", "of which other threads"], rows)

    def sweeps(self):
        figures = self.results.get("sweeps")
        return table(["", "median"], figures and [
            ["processor time, share of all cores, %", digits(100 * figures["busy_share"])],
            ["duration, s", digits(figures["wall_s"])]])
