// Stepper: keeps the moment of a breeding that the glass box shows; steps forward and back, plays, and jumps. The
// moments are: the fitness and its scaling; each pick; each descendant; the complete next generation. No DOM, no clock.

export type Stage = "scaling"|"picking"|"breeding"|"done";

export interface Moment {
  stage: Stage;
  index: number; // of the pick or descendant
}

export const speed_min = 0.25, speed_max = 200; // steps per second

export class Stepper {
  position = 0; // 0 to last_position
  playing = false;
  #speed = 2;
  #picks = 0;
  #descendants = 0;
  #due = 0; // fraction of the next step that has elapsed, 0 to 1

  /** Loads a breeding and goes to its first moment. */
  load(picks: number, descendants: number): void {
    this.#picks = picks;
    this.#descendants = descendants;
    this.go_to(0);
  }

  get moment(): Moment {
    return this.position === 0                         ? {stage: "scaling", index: 0} :
      this.position <= this.#picks                     ? {stage: "picking", index: this.position - 1} :
      this.position <= this.#picks + this.#descendants ? {stage: "breeding", index: this.position - 1 - this.#picks} :
                                                         {stage: "done", index: 0};
  }

  get last_position(): number {
    return this.#picks + this.#descendants + 1;
  }

  get at_begin(): boolean {
    return this.position === 0;
  }

  get at_end(): boolean {
    return this.position === this.last_position;
  }

  begin_of(stage: Stage): number {
    return stage === "scaling" ? 0 :
      stage === "picking"      ? 1 :
      stage === "breeding"     ? 1 + this.#picks :
                                 this.last_position;
  }

  // The following functions perform the user's moves. Each of them also stops playing.

  go_to(position: number): void {
    this.stop();
    this.position = Math.min(Math.max(position, 0), this.last_position);
  }

  step(): void {
    this.go_to(this.position + 1);
  }

  back(): void {
    this.go_to(this.position - 1);
  }

  next_stage(): void {
    const next = (["picking", "breeding", "done"] as const).find((stage) => this.begin_of(stage) > this.position);
    this.go_to(next ? this.begin_of(next) : this.position);
  }

  /** Goes to the first moment of this stage; if already there, of the previous stage. */
  previous_stage(): void {
    const previous =
      (["breeding", "picking", "scaling"] as const).find((stage) => this.begin_of(stage) < this.position);
    this.go_to(previous ? this.begin_of(previous) : this.position);
  }

  stop(): void {
    this.playing = false;
    this.#due = 0;
  }

  /** At the last moment, playing starts from the first moment. */
  play(): void {
    if (this.at_end) {
      this.position = 0;
    }
    this.playing = true;
  }

  play_or_stop(): void {
    if (this.playing) {
      this.stop();
    } else {
      this.play();
    }
  }

  get speed(): number {
    return this.#speed;
  }

  set speed(steps_per_s: number) {
    this.#speed = Math.min(Math.max(steps_per_s, speed_min), speed_max);
  }

  /** While playing, advances by this time. Playing stops at the last moment. */
  advance(seconds: number): void {
    if (!this.playing) {
      return;
    }
    this.#due += seconds * this.#speed;
    const whole = Math.floor(this.#due);
    this.#due -= whole;
    if (whole >= this.last_position - this.position) {
      this.go_to(this.last_position);
    } else {
      this.position += whole;
    }
  }
}
