// What people read around the worlds: the title, buttons of the column, banners, notices, links.

export const app_texts = {
  title: (world: string) => world === "" ? "evod" : `${world} – evod`,
  about: (has_items: boolean, births: boolean) => "Evolution, live: " +
    (births      ? "organisms must find food and avoid poison; healthy ones have children." :
       has_items ? "organisms must find food and avoid poison; the fittest breed the next generation." :
                   "the fittest organisms of each generation breed the next one."),
  no_world: "The server has no world yet.",
  new_world: "New world …",
  skip: "Skip to the world",
  hide_column: "Hide the column",
  hide_column_help: "Hide the column (D)",
  show_column: "Show the column",
  show_column_help: "Show the column (D)",
  help: "Keys and gestures",
  help_help: "Keys and gestures (?)",
  forked: (world: string) => `Forked the world ${world} from this moment`,
  link: "Link to this moment",
  copied: (link: string) => `Copied ${link}`,
  close: "Close",
  lost: (message: string) => `${message || "Connecting"}. Trying again …`,
  has_shut_down: "The server has shut down. Trying again …",
  shuts_down: "The server is about to stop.",
  updated: "The server was updated: reload the page.",
  reload: "Reload",
  frozen: "Your teacher has frozen the class. Everything goes on when the teacher lets it.",
  other_class: "The link leads to a class.",
  join_class: "Join as a new member",
  stay: "Stay",
  student_world: (name: string, of_class: string) => `You see the world of ${name} (${of_class}).`,
  back_to_class: "Back to the class",
  other_token: (session: string) => `The link contains another token. You are connected as ${session}.`,
  use_token: "Use the token of the link",
  keep_token: "Keep mine",
};
