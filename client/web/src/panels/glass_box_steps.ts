// StepControls: the buttons, sliders and keys that move through the steps of a breeding, and play them.
import {speed_max, speed_min, Stepper} from "../breeding/stepper";
import {glass_box_texts} from "../texts/glass_box";
import {h, set_text} from "../widgets/dom";
import {row, symbol_button} from "../widgets/form";

export class StepControls {
  readonly element: HTMLElement;
  readonly stepper = new Stepper();
  #frame = 0;
  readonly #changed: () => void;

  readonly #play = h("button", {
    class: "button glass-play",
    title: glass_box_texts.play_help,
    onclick: () => this.move(() => this.stepper.play_or_stop())
  });
  readonly #speed = h("input", {
    class: "glass-speed",
    type: "range",
    min: Math.log2(speed_min),
    max: Math.log2(speed_max),
    step: "any",
    value: 1,
    "aria-label": glass_box_texts.speed_label,
    oninput: () => this.#set_speed(),
  });
  readonly #speed_text = h("span", {class: "hint"});
  readonly #position: HTMLInputElement = h("input", {
    class: "grow",
    type: "range",
    min: 0,
    step: 1,
    "aria-label": glass_box_texts.position_label,
    oninput: () => this.move(() => this.stepper.go_to(Number(this.#position.value)))
  });
  readonly #position_text = h("span", {class: "hint glass-position"});

  /** changed  called after each move of the user */
  constructor(changed: () => void) {
    this.#changed = changed;
    const button = (text: string, label: string, act: () => void): HTMLElement =>
      symbol_button(text, label, () => this.move(act), "button glass-move");
    const texts = glass_box_texts, stepper = this.stepper;
    this.element =
      h("div", {class: "panel"},
        h("div", {class: "glass-transport"}, button("|<", texts.to_begin, () => stepper.go_to(0)),
          button("<<", texts.previous_stage, () => stepper.previous_stage()),
          button("<", texts.back, () => stepper.back()), this.#play, button(">", texts.forward, () => stepper.step()),
          button(">>", texts.next_stage, () => stepper.next_stage()),
          button(">|", texts.to_end, () => stepper.go_to(stepper.last_position))),
        row(this.#position, this.#position_text), row(this.#speed, this.#speed_text));
    this.#set_speed();
  }

  /** Performs a move of the user. */
  move(act: () => void): void {
    act();
    this.#changed();
  }

  update(): void {
    const {stepper} = this;
    set_text(this.#play, stepper.playing ? glass_box_texts.stop : glass_box_texts.play);
    this.#position.max = String(stepper.last_position);
    this.#position.value = String(stepper.position);
    set_text(this.#position_text, glass_box_texts.position(stepper.position, stepper.last_position));
  }

  #set_speed(): void {
    this.stepper.speed = 2 ** Number(this.#speed.value);
    set_text(this.#speed_text, glass_box_texts.speed(this.stepper.speed));
    this.#speed.setAttribute("aria-valuetext", glass_box_texts.speed_read(this.stepper.speed));
  }

  press(event: KeyboardEvent): void {
    const {stepper} = this, target = event.target;
    const act: {[key: string]: () => void} = {
      ArrowLeft: () => stepper.back(),
      ArrowRight: () => stepper.step(),
      PageUp: () => stepper.previous_stage(),
      PageDown: () => stepper.next_stage(),
      Home: () => stepper.go_to(0),
      End: () => stepper.go_to(stepper.last_position),
      " ": () => stepper.play_or_stop(),
    };
    const move = act[event.key];
    if (
      !move || target instanceof HTMLInputElement || event.ctrlKey || event.altKey || event.metaKey ||
      (event.key === " " && target instanceof HTMLButtonElement)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.move(move);
  }

  /** Plays while the panel is visible.
   *
   *  has_arrived  whether the row of the present moment has arrived; otherwise playing waits */
  animate(panel: HTMLElement, has_arrived: () => boolean): void {
    if (!this.stepper.playing || this.#frame !== 0) {
      return;
    }
    let before = performance.now();
    const step = (now: number): void => {
      this.#frame = 0;
      if (!this.stepper.playing || panel.offsetParent === null) {
        return;
      }
      if (has_arrived()) {
        this.stepper.advance(Math.min((now - before) / 1000, 0.25));
      }
      before = now;
      this.#changed();
      this.#frame ||= this.stepper.playing ? requestAnimationFrame(step) : 0;
    };
    this.#frame = requestAnimationFrame(step);
  }
}
