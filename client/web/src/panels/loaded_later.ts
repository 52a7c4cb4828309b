// The panels that need most code. They are a file of their own, panels.js, which the page loads when one of them is shown.
export {FamilyPanel} from "./family";
export {GlassBoxPanel} from "./glass_box";
export {OrganismPanel} from "./organism";
export {PhysicsPanel} from "./physics";
export {PlotsPanel} from "./plots";
