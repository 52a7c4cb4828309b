// The panels of the column, in the order of their tabs.
import {EventsPanel} from "./events";
import {LazyPanel} from "./lazy";
import type {Panel, PanelContext} from "../world/panel_context";
import {ParametersPanel} from "./parameters";
import {RunPanel} from "./run";
import {ViewPanel} from "./view";
import {WorldsPanel} from "./worlds";

export const panels: ((context: PanelContext) => Panel)[] = [
  (context) => new WorldsPanel(context),
  (context) => new RunPanel(context),
  (context) => new ParametersPanel(context),
  (context) => new ViewPanel(context),
  (context) =>
    new LazyPanel("organism", "Organism", async () => new (await import("./loaded_later")).OrganismPanel(context)),
  (context) =>
    new LazyPanel("glass box", "Glass box", async () => new (await import("./loaded_later")).GlassBoxPanel(context)),
  (context) =>
    new LazyPanel("family", "Family tree", async () => new (await import("./loaded_later")).FamilyPanel(context)),
  (context) => new LazyPanel("plots", "Plots", async () => new (await import("./loaded_later")).PlotsPanel(context)),
  (context) => new EventsPanel(context),
  (context) =>
    new LazyPanel("freezer", "Freezer", async () => new (await import("./loaded_later")).FreezerPanel(context)),
  (context) =>
    new LazyPanel("physics", "Physics", async () => new (await import("./loaded_later")).PhysicsPanel(context)),
];
