// Timings: figures about the worker for tests and benchmarks. Times are those of the last timings_kept snapshots and
// frames.
import type {Figures} from "../core/messages";

const timings_kept = 200;

function keep(times: number[], ms: number): void {
  times.push(ms);
  if (times.length > timings_kept) {
    times.shift();
  }
}

function percentile(times: number[], share: number): number {
  const sorted = [...times].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}

/** What is known here of the Figures. */
type Timed = Omit<Figures, "damaged_snapshots"|"dropped">;

export class Timings {
  snapshot_count = 0;
  reconnect_count = 0;
  readonly #decoded: number[] = []; // ms per snapshot
  readonly #drawn: number[] = []; // ms per frame
  readonly #frames: number[] = []; // when a frame of the last second began

  decoded(ms: number): void {
    keep(this.#decoded, ms);
  }

  drawn(began_ms: number, ended_ms: number): void {
    keep(this.#drawn, ended_ms - began_ms);
    this.#frames.push(began_ms);
    while (this.#frames[0]! < began_ms - 1000) {
      this.#frames.shift();
    }
  }

  figures(now_ms: number): Timed {
    const memory = (performance as {memory?: {usedJSHeapSize: number}}).memory;
    return {
      decode_p50_ms: percentile(this.#decoded, 0.5),
      decode_p95_ms: percentile(this.#decoded, 0.95),
      draw_p50_ms: percentile(this.#drawn, 0.5),
      draw_p95_ms: percentile(this.#drawn, 0.95),
      frames_per_s: this.#frames.filter((at) => at > now_ms - 1000).length,
      snapshots: this.snapshot_count,
      reconnects: this.reconnect_count,
      heap_bytes: memory?.usedJSHeapSize ?? 0,
    };
  }
}
