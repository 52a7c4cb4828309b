// The button that shows generation 1 next to the present.

export const evolution_button_texts = {
  show: "Show evolution",
  show_help: "Shows generation 1 and the present side by side.",
  end: "End the comparison",
  end_help: "Shows only the present again (B).",
};
