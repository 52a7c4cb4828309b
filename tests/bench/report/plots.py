"""The plots of docs/PERFORMANCE.md, as small SVG files."""
import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "evod", "font.size": 9, "axes.grid": True,
                            "grid.alpha": 0.3, "legend.frameon": False})
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

from .page import program_names  # noqa: E402

colours = {"evod": "#d55e00", "box2d": "#0072b2", "chipmunk_hash": "#009e73", "chipmunk_tree": "#56b4e9",
           "all_pairs": "#999999"}


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None, "Creator": None})
    plt.close(figure)
    # One trailing space a line is matplotlib's; git would point at each.
    path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")


def plain_numbers(*sides):
    """Axes of a logarithmic plot with 20, 50, 100 in the place of powers."""
    for side in sides:
        side.set_major_locator(LogLocator(subs=(1, 2, 5)))
        side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
        side.set_minor_formatter(NullFormatter())


def cost(results, path):
    figure, axes = plt.subplots(figsize=(7, 4))
    series = {}
    for row in results["workload"]:
        if row["islands"] == 1 and not row["spatial_order"]:
            rate = "organism_ticks_per_s" if row["threads"] > 1 else "organism_ticks_per_processor_s"
            series.setdefault((row["program"], row["threads"]), []).append((row["organisms"], row[rate]))
    for (program, threads), points in series.items():
        points.sort(key=lambda point: point[0])
        ns = [1e9 / rate["median"] for _, rate in points]
        bars = [[n - 1e9 / rate["max"] for n, (_, rate) in zip(ns, points)],
                [1e9 / rate["min"] - n for n, (_, rate) in zip(ns, points)]]
        label = program_names[program] + (f", {threads} threads" if program == "evod" and threads > 1 else "")
        axes.errorbar([n for n, _ in points], ns, yerr=bars, marker="o", markersize=3, capsize=2, label=label,
                      color=colours[program], linestyle="--" if threads > 1 else "-")
    axes.set(xscale="log", yscale="log", xlabel="organisms", ylabel="ns an organism and tick")
    plain_numbers(axes.yaxis)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.legend(fontsize=8)
    save(figure, path)


def roofline(results, page, path):
    """Instructions a second over instructions a byte: an instruction roofline.

    Source  Williams, Waterman & Patterson 2009, "Roofline"; Ding & Williams 2019, "An instruction roofline model for
    GPUs".
    """
    per_tick = {e["work"]: e["instructions"] / e["units"] for e in results["instructions"]}["ticks"]
    intensity = per_tick / page.bytes_per_organism_tick()
    figure, axes = plt.subplots(figsize=(7, 4))
    reach = [intensity / 20, intensity * 10]
    for name, threads, line in (("one_thread", 1, "-"), ("two_threads", 2, "--")):
        roofs = results["machine"][name]
        for key, colour, label in (("memory_gb_per_s", "#0072b2", "memory"),
                                   ("cache_8_mib_gb_per_s", "#009e73", "8 MiB in cache")):
            knee = roofs["instructions_g_per_s"] / roofs[key]
            axes.plot([reach[0], knee, reach[1]], [reach[0] * roofs[key], *[roofs["instructions_g_per_s"]] * 2], line,
                      color=colour, linewidth=1, label=f"roof: {label}, {threads} thread{'s' * (threads > 1)}")
    for row in results["workload"]:
        if row["program"] == "evod" and row["organisms"] >= 2_000:
            rate = row["organism_ticks_per_s"]["median"] * per_tick / 1e9
            axes.plot(intensity, rate, "o" if row["threads"] == 1 else "s", color="#d55e00", markersize=4)
            axes.annotate(f" {row['organisms']:,}, {row['threads']} thread{'s' * (row['threads'] > 1)}",
                          (intensity, rate), fontsize=7, ha="left" if row["threads"] == 1 else "right")
    axes.set(xscale="log", yscale="log", xlabel="instructions a byte read or written by passes over columns",
             ylabel="G instructions a second")
    plain_numbers(axes.xaxis, axes.yaxis)
    axes.legend(fontsize=7, loc="lower right")
    save(figure, path)


def phases(results, path):
    rows = [row for row in results["phases"] if row["phase"] != "whole tick"]
    populations = sorted({row["organisms"] for row in rows})
    figure, axes = plt.subplots(figsize=(7, 4))
    below = [0.0] * len(populations)
    axes.set_prop_cycle(color=plt.get_cmap("tab20").colors)
    for name in dict.fromkeys(row["phase"] for row in rows):
        ns = [sum(row["ns"]["median"] for row in rows if row["phase"] == name and row["organisms"] == n)
              for n in populations]
        axes.bar([f"{n:,}" for n in populations], ns, bottom=below, label=name, width=0.6)
        below = [a + b for a, b in zip(below, ns)]
    axes.set(xlabel="organisms", ylabel="ns an organism and tick")
    axes.legend(fontsize=7, loc="upper left")
    save(figure, path)
