// One worker a packing: all are given the same commands before the same increment, and none is an increment ahead.

import type { Live } from "./live";
import type { Command, FromWorker, Seen, ToWorker } from "./shared";

const PATIENCE = 30000; // [ms] with an increment

export class Conductor {
  private workers: Worker[] = [];
  private waiting: Command[] = [];
  private given: Command[] = []; // before the present increment
  private answers = 0;
  private dumps: ((dump: Extract<FromWorker, { kind: "dump" }>) => void)[] = [];
  busy = true;
  idle = false;
  paused = false;
  turns = 0;
  most = Infinity; // turns after which it waits, for tests
  spent = 0; // [ms] in kernels, all workers together
  private since = 0;
  private fresh = true; // has no increment been made of these packings yet?
  private broken = false;
  private readonly address = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));

  constructor(
    private readonly live: Live,
    private readonly taken: (pane: number, commands: Command[], seen: Seen | null) => void,
    private readonly finished: () => void,
  ) {}

  // Begin with other packings.
  begin(module: WebAssembly.Module, blocks: ArrayBuffer[][], settings: Command[]) {
    for (const worker of this.workers) worker.terminate();
    this.waiting = settings;
    this.broken = false;
    this.fresh = true;
    this.begun();
    this.answers = blocks.length;
    this.workers = blocks.map(([ints, floats], pane) => {
      const worker = new Worker(this.address);
      worker.onmessage = ({ data }: MessageEvent<FromWorker>) => worker === this.workers[pane] && this.hear(pane, data);
      worker.onerror = () => worker === this.workers[pane] && (this.broken = true);
      this.post(worker, { kind: "load", module, layout: this.live.layout, ints, floats });
      return worker;
    });
  }

  ask(command: Command) {
    const [name, kind] = command;
    const move = this.live.commands.move;
    // Of places where the hand wants a body the latest counts.
    if (name === "command" && kind === move) this.waiting = this.waiting.filter(([other, same]) => other !== name || same !== move);
    this.waiting.push(command);
    this.idle = false;
  }

  // Is there a command that no packing has been given yet?
  get asked(): boolean {
    return this.waiting.length > 0;
  }

  // Is there a command that takes effect while paused, too? What the hand does is not.
  private get unpausable(): boolean {
    return this.waiting.some(([name]) => name !== "command" && name !== "keep");
  }

  // How long the present increment has taken so far [ms].
  get waited(): number {
    return this.busy && !this.broken ? performance.now() - this.since : 0;
  }

  // Will there be no answer any more?
  get silent(): boolean {
    return this.broken || this.waited > PATIENCE;
  }

  // The next increment, once all are done with this one.
  turn() {
    if (this.busy || this.idle || this.turns >= this.most || (this.paused && !this.fresh && !this.unpausable)) return;
    this.fresh = false;
    this.given = this.waiting.splice(0, this.atOnce());
    const message: ToWorker = { kind: "turn", commands: this.given };
    this.begun();
    this.idle = true; // unless somebody has made an increment
    this.answers = this.workers.length;
    for (const worker of this.workers) this.post(worker, message);
  }

  // All that a packing's kernels remember: for tests.
  dump(pane: number): Promise<Extract<FromWorker, { kind: "dump" }>> {
    this.post(this.workers[pane], { kind: "dump" });
    return new Promise((resolve) => this.dumps.push(resolve));
  }

  // How many of the commands that wait are for the next increment: a place that is let go at once still has one to be reached in.
  private atOnce(): number {
    const { move, release } = this.live.commands;
    const at = (kind: number) => this.waiting.findIndex(([name, first]) => name === "command" && first === kind);
    return !this.paused && at(move) >= 0 && at(move) < at(release) ? at(release) : this.waiting.length;
  }

  private begun() {
    this.busy = true;
    this.since = performance.now();
  }

  private post(worker: Worker, message: ToWorker) {
    worker.postMessage(message);
  }

  private hear(pane: number, message: FromWorker) {
    if (message.kind === "dump") {
      this.dumps.shift()?.(message);
      return;
    }
    if (message.kind === "failed") {
      console.error(message.text);
      this.broken = true;
      return;
    }
    if (message.kind === "seen") {
      this.spent += message.time;
      this.taken(pane, this.given, message.seen);
      if (message.seen) this.idle = false;
    } else {
      this.idle = false;
    }
    if (--this.answers) return;
    this.busy = false;
    if (this.asked) this.idle = false;
    this.turns++;
    this.finished();
  }
}
