"""Traces the fittest organism of a run back to the first generation. Plots its ancestors and the history of its genes.

    follow_a_lineage.py [--generations N] [--output FILE]
"""
import argparse
import tempfile

import matplotlib.pyplot as plt

import evod

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--generations", type=int, default=30)
parser.add_argument("--output", default="follow_a_lineage.png")
options = parser.parse_args()

with tempfile.TemporaryDirectory() as folder:
    with evod.local(seed=42, data=folder, experiment={"selection": "tournament"}) as lab:
        last = lab.world().run(options.generations).wait()
    with evod.open_run(folder + "/default.evod") as run:
        fittest = last.number, 0, last.islands[0].best_organism
        lineage, organisms = run.lineage(fittest), run.organisms()
        figure, (left, right) = plt.subplots(1, 2, figsize=(13, 6))
        run.plot_lineage(fittest, left)

# Follows the first parent of each organism, because the child has most of its genes from this parent.
organisms = organisms.set_index(["generation", "island", "organism"])
line, name = [], fittest
while True:
    line.append(name)
    row = lineage.set_index(["generation", "island", "organism"]).loc[name]
    if row["origin"] == "initial":
        break
    name = tuple(int(row[f"parent_first{part}"]) for part in ("_generation", "_island", ""))
genes = organisms.loc[line, list(evod.GENE_NAMES)]
for gene in evod.GENE_NAMES:
    right.step([name[0] for name in line], genes[gene], where="mid", label=gene)
right.set(xlabel="generation", ylabel="gene of the first parents")
right.legend(frameon=False)
figure.savefig(options.output)
print(f"organism {fittest[2]} of generation {fittest[0]} has {len(lineage) - 1} ancestors; its line of first parents "
      "begins with "
      f"organism {line[-1][2]} of generation {line[-1][0]}")
