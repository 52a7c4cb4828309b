// Legend of a family tree: what the colours of its organisms mean.
import {type Legend, scale_gradient} from "../family/colouring";
import {family_texts} from "../texts/family";
import {three_digits} from "../texts/numbers";
import {h} from "../widgets/dom";

/** first_generation  the generation from which lineages are counted */
export function legend_parts(legend: Legend, first_generation: number): Node[] {
  switch (legend.kind) {
    case "nothing":
      return [];
    case "lineages":
      return [
        h("span", {}, family_texts.legend_lineages(first_generation)),
        ...legend.lineages.map(({founder, count, colour}) => {
          const swatch = h("span", {class: "family-swatch"});
          swatch.style.background = colour;
          return h("span", {}, swatch, family_texts.legend_lineage(founder, count));
        }),
        ...(
          legend.others.count > 0 ?
            [h("span", {}, family_texts.legend_others(legend.others.lineages, legend.others.count))] :
            []),
        h("span", {}, family_texts.legend_grey),
      ];
    case "scale": {
      const bar = h("span", {class: "family-scale"});
      bar.style.background = scale_gradient;
      return [
        ...(
          legend.least <= legend.most ? [h("span", {}, three_digits(legend.least), bar, three_digits(legend.most))] :
                                        []),
        ...(legend.unknown > 0 ? [h("span", {}, family_texts.legend_unknown(legend.unknown))] : []),
      ];
    }
  }
}
