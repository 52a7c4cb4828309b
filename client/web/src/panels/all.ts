// The panels of the column, in the order of their tabs.
import {panels_texts as texts} from "../texts/panels";
import type {Panel, PanelContext} from "../world/panel_context";

import {EventsPanel} from "./events";
import {LazyPanel} from "./lazy";

type Later = typeof import("./loaded_later");

/** A panel whose code is in panels.js. */
function later(name: string, title: string, make: (loaded: Later, context: PanelContext) => Panel):
  (context: PanelContext) => Panel {
  return (context) => new LazyPanel(name, title, async () => make(await import("./loaded_later"), context));
}

/** The panel of those who may have classes. */
export const class_panel = later("class", texts.class, ({ClassPanel}, context) => new ClassPanel(context));

export const panels: ((context: PanelContext) => Panel)[] = [
  later("worlds", texts.worlds, ({WorldsPanel}, context) => new WorldsPanel(context)),
  later("run", texts.run, ({RunPanel}, context) => new RunPanel(context)),
  later("parameters", texts.parameters, ({ParametersPanel}, context) => new ParametersPanel(context)),
  later("view", texts.view, ({ViewPanel}, context) => new ViewPanel(context)),
  later("organism", texts.organism, ({OrganismPanel}, context) => new OrganismPanel(context)),
  later("glass box", texts.glass_box, ({GlassBoxPanel}, context) => new GlassBoxPanel(context)),
  later("family", texts.family, ({FamilyPanel}, context) => new FamilyPanel(context)),
  later("plots", texts.plots, ({PlotsPanel}, context) => new PlotsPanel(context)),
  (context) => new EventsPanel(context),
  later("lesson", texts.lesson, ({LessonPanel}, context) => new LessonPanel(context)),
  later("freezer", texts.freezer, ({FreezerPanel}, context) => new FreezerPanel(context)),
  later("physics", texts.physics, ({PhysicsPanel}, context) => new PhysicsPanel(context)),
];
