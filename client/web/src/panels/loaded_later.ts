// The panels that need most code, and the dialog for new worlds. They are a file of their own, panels.js, which the
// page loads when one of them is first shown.
export {FamilyPanel} from "./family";
export {FreezerPanel} from "./freezer";
export {GlassBoxPanel} from "./glass_box";
export {new_world_dialog} from "./new_world";
export {OrganismPanel} from "./organism";
export {PhysicsPanel} from "./physics";
export {PlotsPanel} from "./plots";
