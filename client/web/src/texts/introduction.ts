// The introduction: three steps for people who see the page for the first time.
import shared from "../../../../proto/texts/viewers.json";

export interface IntroductionStep {
  title: string;
  text: string;
}

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
  {
    title: "What you can do",
    text: "Compare generation 1 with the present. Click an organism. Press “Take part” to run, feed and change " +
      "this world.",
  },
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
