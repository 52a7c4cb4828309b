// GenerationHold: pauses a world after each generation, so that the user can inspect how the next one was bred. A world
// that has finished a generation waits before it breeds; the first tick of the next generation performs the breeding.
// GenerationHold therefore asks for two commands: run one generation, then step one tick. No DOM.

export class GenerationHold {
  #run = ""; // the held run; "": none
  #limited = false; // the world runs the requested generation

  /** run  the name of the world and the id of its run: a replay has the id of the run that it shows */
  hold(run: string): void {
    this.#run = run;
    this.#limited = false;
  }

  release(): void {
    this.hold("");
  }

  get on(): boolean {
    return this.#run !== "";
  }

  /** Returns the command to send to the world now. Ends the hold if another run is shown.
   *
   *  stepping  whether the world runs to a given tick and pauses there */
  update(run: string, state: string, stepping: boolean): "none"|"run one generation"|"step one tick" {
    if (this.#run !== run) {
      this.release();
    } else if (this.on && state === "RUN_STATE_RUNNING" && !stepping && !this.#limited) {
      this.#limited = true;
      return "run one generation";
    } else if (this.on && state === "RUN_STATE_WAITING" && this.#limited) {
      this.#limited = false;
      return "step one tick";
    }
    return "none";
  }
}
