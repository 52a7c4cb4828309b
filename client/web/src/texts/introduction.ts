// The introduction: three steps for people who see the page for the first time.
import shared from "../../../../proto/texts/viewers.json";

export interface IntroductionStep {
  title: string;
  text: string;
}

const can_do = {
  title: "What you can do",
  with_bodies: "Compare generation 1 with the present. Click an organism. Press “Take part” to run, feed and " +
    "change this world.",
  without_bodies: "Compare generation 1 with the present. Press “Take part” to run and change this world.",
};

export const introduction_steps: readonly IntroductionStep[] = [
  {
    title: "What you see",
    text: `${shared.what_it_is} The ring around each one is its health. Food is green, poison is red.`,
  },
  {
    title: "What they want",
    text: "They look for food and avoid poison. Those that do well have more children. The overview names the " +
      "healthiest; its curve is the fitness of each generation.",
  },
  {title: can_do.title, text: can_do.with_bodies},
];

/** The steps in a world whose organisms do not live on an island. */
export const introduction_steps_without_bodies: readonly IntroductionStep[] = [
  {
    title: "What you see",
    text: "A population that is bred generation by generation. Each line is an organism: it crosses the axis of each " +
      "gene at the value of the gene.",
  },
  {
    title: "What counts",
    text: "Only the genes decide the fitness. Organisms with a higher fitness have more children. The overview names " +
      "the best solution; its curve is the fitness of each generation.",
  },
  {title: can_do.title, text: can_do.without_bodies},
];

export const introduction_texts = {
  name: "Introduction",
  step: (step: number, count: number) => `${step} of ${count}`,
  back: "Back",
  next: "Next",
  skip: "Skip",
  done: "Done",
  again: "Show the introduction",
};
