// Texts of widgets.
export const widget_texts = {
  close_message: "Close the message",
  theme: {"": "Theme: as the system", dark: "Theme: dark", light: "Theme: light"},
};
