// Texts about the panels themselves: the titles of those that are loaded later, and why one is not shown yet.
export const panels_texts = {
  worlds: "Worlds",
  run: "Run",
  parameters: "Parameters",
  view: "View",
  organism: "Organism",
  glass_box: "Glass box",
  family: "Family tree",
  plots: "Plots",
  physics: "Physics",
  lesson: "Lesson",
  freezer: "Freezer",
  class: "Class",
  loading: "Loading …",
  not_loaded: (why: string) => `The panel cannot be loaded: ${why}.`,
};
