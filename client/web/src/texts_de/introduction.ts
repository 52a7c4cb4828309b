// The introduction: three steps for people who see the page for the first time.
import shared from "../../../../proto/texts/de/viewers.json";
import type * as english from "../texts/introduction";

export type{IntroductionStep} from "../texts/introduction";

const can_do = {
  title: "Was möglich ist",
  with_bodies: "Generation 1 mit der Gegenwart vergleichen. Einen Organismus anklicken. Mit „Mitmachen“ diese Welt " +
    "starten, füttern und ändern.",
  without_bodies: "Generation 1 mit der Gegenwart vergleichen. Mit „Mitmachen“ diese Welt starten und ändern.",
};

export const introduction_steps: typeof english.introduction_steps = [
  {
    title: "Was zu sehen ist",
    text: `${shared.what_it_is} Der Ring um jeden Organismus ist seine Gesundheit. Futter ist grün, Gift ist rot.`,
  },
  {
    title: "Was sie wollen",
    text:
      "Sie suchen Futter und meiden Gift. Wer das gut kann, hat mehr Kinder. Die Übersicht nennt die gesündesten; " +
      "ihre Kurve ist die Fitness jeder Generation.",
  },
  {title: can_do.title, text: can_do.with_bodies},
];

export const introduction_steps_without_bodies: typeof english.introduction_steps_without_bodies = [
  {
    title: "Was zu sehen ist",
    text:
      "Eine Population, die Generation für Generation gezüchtet wird. Jede Linie ist ein Organismus: Sie schneidet " +
      "die Achse jedes Gens beim Wert des Gens.",
  },
  {
    title: "Was zählt",
    text: "Nur die Gene bestimmen die Fitness. Organismen mit höherer Fitness haben mehr Kinder. Die Übersicht nennt " +
      "die beste Lösung; ihre Kurve ist die Fitness jeder Generation.",
  },
  {title: can_do.title, text: can_do.without_bodies},
];

export const introduction_texts: typeof english.introduction_texts = {
  name: "Einführung",
  step: (step, count) => `${step} von ${count}`,
  back: "Zurück",
  next: "Weiter",
  skip: "Überspringen",
  done: "Fertig",
  again: "Einführung zeigen",
};
