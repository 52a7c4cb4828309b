// The panels that need most code, the dialogs, and evolution. They are a file of their own, panels.js, which the page
// loads when one of them is first shown.
export {JoinForm} from "../class/join_form";
export {ClassPanel} from "../class/panel";
export {ClassWall} from "../class/wall";
export {genes_of_best} from "./best_genes";
export {Evolution} from "./evolution";
export {FamilyPanel} from "./family";
export {FreezerPanel} from "./freezer";
export {GlassBoxPanel} from "./glass_box";
export {Help} from "./help";
export {LessonPanel} from "./lesson";
export {new_world_dialog} from "./new_world";
export {OrganismPanel} from "./organism";
export {ParametersPanel} from "./parameters";
export {PhysicsPanel} from "./physics";
export {PlotsPanel} from "./plots";
export {PopulationView} from "./population_view";
export {RunPanel} from "./run";
export {SecondWorld} from "./second_world";
export {ViewPanel} from "./view";
export {WorldsPanel} from "./worlds";
