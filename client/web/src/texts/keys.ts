// What keys answer.

export const key_texts = {
  panel: (title: string) => `show the panel ${title}`,
  end_of_replay: "This is the end of the replay; [ goes back by a generation.",
  run_has_ended: "The run has ended; resetting the world starts it again.",
  is_live: "The world is live; P replays its run.",
  colour: (name: string) => `Colour: ${name || "none"}`,
};
